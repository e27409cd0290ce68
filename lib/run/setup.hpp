#pragma once
// The output folder and the log of a run, before its first step.

#include "run/job.hpp"

namespace mpm {

/// Takes the lock of the output folder on the first rank, if the folder can be written into; that another run
/// has it becomes a line for the user on every rank. Collective.
PetscErrorCode lock_folder(Job& job);

/// Makes the output folder and takes its lock; where another run has that, the outcome is bad input.
PetscErrorCode take_folder(Job& job);

/// The log's first lines, to the terminal until the file is open.
PetscErrorCode begin_log(Job& job);

/// Opens the log in the output folder, and writes the options in force. Results of an earlier run go, unless
/// this one goes on with them.
PetscErrorCode open_folder(Job& job, bool goes_on);

/// Backend, device and processor, as the key of what is measured once for them.
std::string device_key(Backend backend);

}  // namespace mpm
