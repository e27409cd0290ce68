#pragma once
// Which files of an output folder are the program's: by name, and by what is in them. A file of a user is
// never removed and never written over, whatever its name. Everything here is called on one rank.

#include <petscsys.h>

#include <optional>
#include <string>
#include <vector>

namespace mpm {

/// The step in "checkpoint_STEP.h5", and the number in "frame_NNNNN.h5"; none where a name is not exactly so.
std::optional<long> checkpoint_number(const std::string& name);
std::optional<long> frame_number(const std::string& name);

/// Whether a name without its folder is one under which a run writes, unfinished ones (.tmp) included;
/// `in_frames`: in the folder `frames`.
bool is_written_name(const std::string& name, bool in_frames);

/// Whether a file under such a name, or that of a picture of scripts/plot, is what its name says: it begins
/// as the program's own do. Empty, unfinished and damaged ones are; links, pipes and folders are not.
bool is_own_file(const std::string& path);

/// Paths of all files in an output folder and its `frames` under names that a run writes.
std::vector<std::string> written_names(const std::string& folder);

/// The first of them that is not the program's own; empty if there is none.
std::string foreign_file(const std::string& folder);

/// Removes a file if it is the program's own, and adds one to `removed` [files].
PetscErrorCode remove_own(const std::string& path, int* removed);

}  // namespace mpm
