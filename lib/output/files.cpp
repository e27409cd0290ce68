#include "output/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include "output/own_files.hpp"

namespace mpm {
namespace fs = std::filesystem;

namespace {

/// Removes the program's own files from one folder and adds their number to `removed`.
PetscErrorCode remove_ours(const fs::path& folder, int* removed) {
  PetscFunctionBeginUser;
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    paths.push_back(it->path().string());
  PetscCheck(!error, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot read the folder %s: %s", folder.c_str(),
             error.message().c_str());
  for (const std::string& path : paths) PetscCall(remove_own(path, removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode make_folder(const std::string& folder) {
  PetscFunctionBeginUser;
  std::error_code error;
  fs::create_directories(folder, error);
  PetscCheck(!error, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot make the folder %s: %s", folder.c_str(),
             error.message().c_str());
  PetscCheck(fs::is_directory(folder, error), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN,
             "Cannot make the folder %s: a file of that name stands there", folder.c_str());
  PetscCheck(::access(folder.c_str(), W_OK | X_OK) == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN,
             "Cannot write into the folder %s: %s", folder.c_str(), std::strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode prepare_output_folder(const std::string& folder, int* removed, bool with_frames) {
  PetscFunctionBeginUser;
  const fs::path frames = fs::path(folder) / "frames";
  int count = 0;
  PetscCall(make_folder(folder));
  if (with_frames) PetscCall(make_folder(frames.string()));
  PetscCall(remove_ours(folder, &count));
  if (std::error_code error; with_frames || fs::is_directory(frames, error))
    PetscCall(remove_ours(frames, &count));
  if (removed) *removed = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_new_file(const std::string& path, std::initializer_list<std::string_view> parts) {
  PetscFunctionBeginUser;
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  PetscCheck(descriptor >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", path.c_str(),
             std::strerror(errno));
  PetscErrorCode failed = PETSC_SUCCESS;
  for (const std::string_view part : parts)
    if (!failed) failed = write_all(descriptor, part, path);
  int reason = ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;  // EINVAL: nothing to bring there
  if (::close(descriptor) != 0 && reason == 0) reason = errno;
  PetscCall(failed);
  PetscCheck(reason == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
             std::strerror(reason));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode rename_file(const std::string& from, const std::string& to) {
  PetscFunctionBeginUser;
  PetscCheck(std::rename(from.c_str(), to.c_str()) == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE,
             "Cannot rename %s to %s: %s", from.c_str(), to.c_str(), std::strerror(errno));
  const std::string folder = fs::path(to).parent_path().string();
  PetscCall(bring_to_disk(folder.empty() ? "." : folder));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode bring_to_disk(const std::string& path) {
  PetscFunctionBeginUser;
  int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  PetscCheck(descriptor >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", path.c_str(),
             std::strerror(errno));
  const int reason = ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;
  PetscCall(close_file(&descriptor, path));
  PetscCheck(reason == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
             std::strerror(reason));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode replace_file(const std::string& path, std::string_view contents) {
  PetscFunctionBeginUser;
  const std::string temporary = path + ".tmp";
  PetscErrorCode failed = write_new_file(temporary, {contents});
  if (!failed) failed = rename_file(temporary, path);
  if (failed) ::unlink(temporary.c_str());
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_all(int descriptor, std::string_view contents, const std::string& path) {
  PetscFunctionBeginUser;
  for (size_t done = 0; done < contents.size();) {
    const ssize_t written = ::write(descriptor, contents.data() + done, contents.size() - done);
    if (written < 0 && errno == EINTR) continue;
    PetscCheck(written >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
               std::strerror(errno));
    done += static_cast<size_t>(written);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode close_file(int* descriptor, const std::string& path) {
  PetscFunctionBeginUser;
  const int open = *descriptor;
  *descriptor = -1;
  PetscCheck(open < 0 || ::close(open) == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s",
             path.c_str(), std::strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
