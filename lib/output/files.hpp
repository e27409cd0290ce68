#pragma once
// Files of the output folder: each is complete or absent, for it is written under a temporary name and
// renamed. Everything here is called on one rank. Errors name the file and the system's reason.

#include <petscsys.h>

#include <initializer_list>
#include <string>
#include <string_view>

namespace mpm {

/// Makes a folder, with its parents, and checks that files can be made in it. Fails with PETSC_ERR_FILE_OPEN.
PetscErrorCode make_folder(const std::string& folder);

/// Makes the output folder and its `frames`, and removes what an earlier run left there (own_files.hpp),
/// nothing else. Call it after the input has been found valid. `removed` [number of files] is for the log; it
/// may be null. Without `frames` that folder is not made.
PetscErrorCode prepare_output_folder(const std::string& folder, int* removed, bool with_frames = true);

/// Writes `contents` under a temporary name, brings it to the disk and renames it to `path`. If any of this
/// fails the temporary file is removed and a former `path` stays as it was.
PetscErrorCode replace_file(const std::string& path, std::string_view contents);

/// Writes a new file of these parts and brings it to the disk: some file systems report a full disk only
/// then.
PetscErrorCode write_new_file(const std::string& path, std::initializer_list<std::string_view> parts);

/// Renames a file and brings its new name to the disk.
PetscErrorCode rename_file(const std::string& from, const std::string& to);

/// Brings a file, or the names in a folder, to the disk; a system that cannot do that for a folder is passed
/// over.
PetscErrorCode bring_to_disk(const std::string& path);

/// Writes all of `contents` to a file descriptor, in one call where the system lets it; `path` is for the
/// message.
PetscErrorCode write_all(int descriptor, std::string_view contents, const std::string& path);

/// Closes a file descriptor and sets it to -1; nothing where it is -1. The system may report only now that a
/// write failed; `path` is for the message.
PetscErrorCode close_file(int* descriptor, const std::string& path);

}  // namespace mpm
