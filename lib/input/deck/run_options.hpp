#pragma once
// The options in force, for the log and for scripts.

#include <petscsys.h>

#include <string>
#include <vector>

#include "input/deck/report.hpp"

namespace mpm {

/// A table of name, value, unit and origin (given or default), a line each.
std::string format_options(const std::vector<EffectiveOption>& options);

/// Writes FOLDER/options.json: {"version": ..., "options": {name without its dash: value, ...}}; values are
/// text, as on the command line.
PetscErrorCode write_options_json(const std::string& folder, const std::string& version,
                                  const std::vector<EffectiveOption>& options);

}  // namespace mpm
