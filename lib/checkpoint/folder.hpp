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

/// Removes all checkpoints but the last two. Nothing here removes a file that is not the program's own.
PetscErrorCode keep_last_checkpoints(const std::string& folder);

/// Makes a folder ready to go on in: files that were not finished are removed. `removed` [files] is added to.
PetscErrorCode remove_unfinished(const std::string& folder, int* removed);

/// Removes what a run wrote after `step` steps, or after `frames` frames, before another went back to them.
/// To be called once what the other has written since is safe.
PetscErrorCode remove_later_checkpoints(const std::string& folder, long step, int* removed);
PetscErrorCode remove_later_frames(const std::string& folder, long frames, int* removed);

}  // namespace mpm
