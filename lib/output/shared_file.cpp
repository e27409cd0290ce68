#include "output/shared_file.hpp"

#include <fcntl.h>
#include <mpi.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/collectives.hpp"
#include "output/files.hpp"

namespace mpm {
namespace fs = std::filesystem;

namespace {

/// Every call of MPI-IO passes here.
PetscErrorCode check_io(int result, const std::string& path) {
  PetscFunctionBeginUser;
  if (result == MPI_SUCCESS) PetscFunctionReturn(PETSC_SUCCESS);
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(result, text, &length);
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(), text);
}

/// Copies bytes [from, to) of one descriptor to the same place of another.
PetscErrorCode copy_range(int in, int out, long long from, long long to, const std::string& path) {
  PetscFunctionBeginUser;
  std::vector<char> buffer(1 << 16);
  while (from < to) {
    const ssize_t got = ::pread(in, buffer.data(), std::min<long long>(buffer.size(), to - from), from);
    const ssize_t put = got > 0 ? ::pwrite(out, buffer.data(), got, from) : -1;
    PetscCheck(put > 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
               std::strerror(errno));
    from += put;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rank 0: the file with its full size on the disk, and all of the layout but the stretches.
PetscErrorCode fill_from_layout(int made, const std::string& path, int layout,
                                const std::vector<Stretch>& stretches) {
  PetscFunctionBeginUser;
  struct stat status {};
  int reason = ::fstat(layout, &status) == 0 ? 0 : errno;
  if (reason == 0) reason = ::posix_fallocate(made, 0, status.st_size);
  PetscCheck(reason == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
             std::strerror(reason));
  std::vector<std::pair<long long, long long>> gaps;  // from, to
  for (const Stretch& stretch : stretches)
    if (stretch.size > 0) gaps.emplace_back(stretch.offset, stretch.offset + stretch.size);
  std::sort(gaps.begin(), gaps.end());
  long long at = 0;
  for (const auto& [from, to] : gaps) {
    PetscCall(copy_range(layout, made, at, from, path));
    at = to;
  }
  PetscCall(copy_range(layout, made, at, status.st_size, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode start_file(const std::string& path, int layout, const std::vector<Stretch>& stretches) {
  PetscFunctionBeginUser;
  int made = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  PetscCheck(made >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
             std::strerror(errno));
  const PetscErrorCode failed = fill_from_layout(made, path, layout, stretches);
  const PetscErrorCode closed = close_file(&made, path);
  PetscCall(failed);
  PetscCall(closed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Writes this rank's part of a stretch. Collective where the stretch is shared.
PetscErrorCode write_stretch(MPI_File file, const Stretch& stretch, const std::string& path) {
  PetscFunctionBeginUser;
  MPI_Datatype row;  // counts are of rows, so that they stay below 2^31
  PetscCallMPI(MPI_Type_contiguous(stretch.width, MPI_BYTE, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  const int rows = static_cast<int>(stretch.rows);
  const auto write = stretch.shared ? MPI_File_write_at_all : MPI_File_write_at;
  const int result = write(file, stretch.place, stretch.data, rows, row, MPI_STATUS_IGNORE);
  PetscCallMPI(MPI_Type_free(&row));
  PetscCall(check_io(result, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_stretches(MPI_Comm comm, const std::string& path,
                               const std::vector<Stretch>& stretches) {
  PetscFunctionBeginUser;
  MPI_File file;
  PetscCall(
      agree(comm, check_io(MPI_File_open(comm, path.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file), path)));
  PetscErrorCode failed = PETSC_SUCCESS;
  for (const Stretch& stretch : stretches) {
    if (stretch.size == 0 || (!stretch.shared && stretch.rows == 0)) continue;
    const PetscErrorCode here = write_stretch(file, stretch, path);
    if (!failed) failed = here;  // go on: the calls are collective
  }
  const PetscErrorCode closed = check_io(MPI_File_close(&file), path);
  PetscCall(agree(comm, failed ? failed : closed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode open_layout(std::string* name, int* descriptor) {
  PetscFunctionBeginUser;
  std::error_code error;
  const std::string memory = "/dev/shm";
  *name = (fs::is_directory(memory, error) ? memory : fs::temp_directory_path(error).string()) +
          "/mpm_layout_XXXXXX";
  *descriptor = ::mkostemp(name->data(), O_CLOEXEC);
  PetscCheck(*descriptor >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", name->c_str(),
             std::strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_shared_file(MPI_Comm comm, const std::string& path, int layout,
                                 const std::vector<Stretch>& stretches) {
  PetscFunctionBeginUser;
  const bool first = rank_of(comm) == 0;
  PetscErrorCode failed = agree(comm, first ? start_file(path, layout, stretches) : PETSC_SUCCESS);
  if (!failed) failed = write_stretches(comm, path, stretches);
  if (!failed) failed = agree(comm, first ? bring_to_disk(path) : PETSC_SUCCESS);
  if (first && failed) ::unlink(path.c_str());
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
