#pragma once
#include "run/job.hpp"

namespace mpm {

inline bool is_element(const Config& config) { return !config.element.file.empty(); }

/// -element_path: the run of a single material point.
PetscErrorCode run_element(Job& job);

}  // namespace mpm
