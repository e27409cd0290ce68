// A frame of several ranks. Its structure is made by HDF5 in the memory of rank 0; the numbers are written by
// all ranks, each to its place, by MPI-IO. HDF5 itself never touches the disk: it does not survive one that
// fills.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "output/files.hpp"
#include "output/frames.hpp"
#include "parallel/together.hpp"

namespace mpm {
namespace {

/// Every call of MPI-IO passes here: it tells of a full disk.
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

/// Rank 0: the file with its full size on the disk, and all of it but the bodies' numbers. `made` stays open.
PetscErrorCode start_file(const std::string& path, const Snapshot& snapshot, Precision precision,
                          const FrameStyle& style, std::vector<FrameSlab>* slabs, int* made) {
  PetscFunctionBeginUser;
  int layout = -1;
  const PetscErrorCode failed = lay_out_frame(path, snapshot, precision, style, &layout, slabs);
  struct stat status {};
  if (failed == PETSC_SUCCESS) ::fstat(layout, &status);
  *made = failed ? -1 : ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const int full = *made < 0 ? errno : ::posix_fallocate(*made, 0, status.st_size);
  PetscErrorCode copied = PETSC_SUCCESS;
  long long at = 0;  // slabs lie in the order in which they were made
  for (std::size_t n = 0; n <= slabs->size() && !failed && full == 0 && !copied; ++n) {
    const bool last = n == slabs->size();
    const FrameSlab* slab = last ? nullptr : &(*slabs)[n];
    if (slab && slab->offset < 0) continue;  // no particles
    copied = copy_range(layout, *made, at, last ? status.st_size : slab->offset, path);
    if (slab) at = slab->offset + slab->bytes * slab->components * snapshot.bodies[slab->body].total;
  }
  if (layout >= 0) ::close(layout);
  PetscCall(failed);
  PetscCheck(full == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(),
             std::strerror(full));
  PetscCall(copied);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// This rank's particles of one field, to their place in the file.
PetscErrorCode write_slab(MPI_File file, const FrameSlab& slab, const ParticleSnapshot& body,
                          const std::string& path) {
  PetscFunctionBeginUser;
  const std::vector<double>& values = body.*slab.values;
  const int count = static_cast<int>(values.size());
  const MPI_Offset at = slab.offset + MPI_Offset(slab.bytes) * slab.components * body.first;
  if (slab.bytes == sizeof(double)) {
    PetscCall(
        check_io(MPI_File_write_at_all(file, at, values.data(), count, MPI_DOUBLE, MPI_STATUS_IGNORE), path));
  } else {
    const std::vector<float> single(values.begin(), values.end());
    PetscCall(
        check_io(MPI_File_write_at_all(file, at, single.data(), count, MPI_FLOAT, MPI_STATUS_IGNORE), path));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// All ranks: the numbers of the bodies.
PetscErrorCode write_slabs(MPI_Comm comm, const std::string& path, const Snapshot& snapshot,
                           const std::vector<FrameSlab>& slabs) {
  PetscFunctionBeginUser;
  MPI_File file;
  PetscCall(
      agree(comm, check_io(MPI_File_open(comm, path.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file), path)));
  PetscErrorCode failed = PETSC_SUCCESS;
  for (const FrameSlab& slab : slabs) {
    if (slab.offset < 0) continue;
    const PetscErrorCode here = write_slab(file, slab, snapshot.bodies[slab.body], path);
    if (failed == PETSC_SUCCESS) failed = here;  // go on: the calls are collective
  }
  const PetscErrorCode closed = check_io(MPI_File_close(&file), path);
  PetscCall(agree(comm, failed ? failed : closed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rank 0: the temporary file becomes the frame.
PetscErrorCode finish_file(int* made, const std::string& temporary, const std::string& path) {
  PetscFunctionBeginUser;
  const bool whole = ::fsync(*made) == 0 || errno == EINVAL;
  PetscCheck(whole && std::rename(temporary.c_str(), path.c_str()) == 0, PETSC_COMM_SELF,
             PETSC_ERR_FILE_WRITE, "Cannot write %s: %s", path.c_str(), std::strerror(errno));
  PetscCall(close_file(made, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode write_frame_together(MPI_Comm comm, const std::string& path, const Snapshot& snapshot,
                                    Precision precision, const FrameStyle& style) {
  PetscFunctionBeginUser;
  const std::string temporary = path + ".tmp";
  const bool first = rank_of(comm) == 0;
  std::vector<FrameSlab> slabs;
  int made = -1;
  PetscErrorCode failed =
      agree(comm, first ? start_file(temporary, snapshot, precision, style, &slabs, &made) : PETSC_SUCCESS);
  if (!failed) {
    long count = static_cast<long>(slabs.size());
    MPI_Bcast(&count, 1, MPI_LONG, 0, comm);
    slabs.resize(count);
    MPI_Bcast(slabs.data(), static_cast<int>(count * sizeof(FrameSlab)), MPI_BYTE, 0, comm);
    failed = write_slabs(comm, temporary, snapshot, slabs);
  }
  if (!failed) failed = agree(comm, first ? finish_file(&made, temporary, path) : PETSC_SUCCESS);
  if (first && failed) {
    if (made >= 0) ::close(made);
    ::unlink(temporary.c_str());
  }
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
