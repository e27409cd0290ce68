#pragma once
// Files of the output folder: each is complete or absent, for it is written under a temporary name and renamed.
// Everything here is called on one rank. Errors name the file and the system's reason.

#include <petscsys.h>

#include <functional>
#include <string>

namespace mpm {

/// Makes a folder, with its parents, and checks that files can be made in it. Fails with PETSC_ERR_FILE_OPEN.
PetscErrorCode make_folder(const std::string& folder);

/// Makes the output folder and its `frames`, and removes what an earlier run left there under our names
/// (history.csv, mpm.log, options.json, particles.xdmf, frames/frame_*.h5 and temporary files), nothing else.
/// Call it once the input is known to be valid. `removed` [number of files] is for the log; it may be null.
PetscErrorCode prepare_output_folder(const std::string& folder, int* removed);

/// Lets `write` make the file under the temporary name that it is given, then renames it to `path`. If either
/// fails the temporary file is removed and a former `path` stays as it was.
PetscErrorCode replace_file(const std::string& path, const std::function<PetscErrorCode(const std::string&)>& write);

/// The same for a text.
PetscErrorCode replace_text_file(const std::string& path, const std::string& text);

/// Writes the whole text to a file descriptor in one call where the system lets it; `path` is for the message.
PetscErrorCode write_all(int descriptor, const std::string& text, const std::string& path);

}  // namespace mpm
