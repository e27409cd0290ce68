#pragma once
// The performance report for scripts.

#include <petscsys.h>

#include <string>

#include "output/performance.hpp"

namespace mpm {

/// The report as JSON, in SI units with the unit in the name; docs/running.md lists the members. Unknown
/// values are null.
std::string performance_json(const Performance& p);

/// Writes FOLDER/performance.json, whole or not at all. On one rank.
PetscErrorCode write_performance_json(const std::string& folder, const Performance& p);

/// Removes FOLDER/performance.json where a run goes on: were that killed, the file of the part before would
/// pass for its own. On one rank.
PetscErrorCode forget_performance_json(const std::string& folder);

}  // namespace mpm
