#pragma once
// The checkpoints of an output folder. Everything here is called on one rank.

#include <petscsys.h>

#include <string>
#include <vector>

namespace mpm {

/// "FOLDER/checkpoint_STEP.h5".
std::string checkpoint_path(const std::string& folder, long step);

/// Steps of the checkpoints in a folder, the earliest first; none where it cannot be read.
std::vector<long> checkpoint_steps(const std::string& folder);

/// Removes all checkpoints but the last two.
PetscErrorCode keep_last_checkpoints(const std::string& folder);

/// Makes a folder ready to go on after `step` steps and `frames` frames: what a run wrote there later, and
/// files that were not finished, are removed; the run writes them again. `removed` [files] is for the log.
PetscErrorCode go_back_to(const std::string& folder, long step, long frames, int* removed);

}  // namespace mpm
