#pragma once
// A file that several ranks write. HDF5 makes its structure in memory, a layout; the numbers are written by
// all ranks, each to their place, by MPI-IO. HDF5 itself never touches the disk: on one that fills it crashes
// at the end of the program, and with several ranks it waits for ever.

#include <petscsys.h>

#include <string>
#include <vector>

namespace mpm {

/// A stretch of the file with numbers that the layout has not.
struct Stretch {
  long long offset = 0, size = 0;  // bytes, on every rank the same; none where size is 0
  bool shared = true;              // among the ranks; else one of them has all of it, the others no rows
  // This rank has `rows` of the stretch, of `width` bytes each, which go to `place`.
  long long place = 0, rows = 0;
  int width = 1;
  const void* data = nullptr;
};

/// A file in memory (/dev/shm), whose holes take none: open for as long as the descriptor is, and without a
/// name once the caller has removed that.
PetscErrorCode open_layout(std::string* name, int* descriptor);

/// Writes `path` and brings it to the disk. Rank 0 gives the layout, and makes room for all of the file
/// before any number is written, so that a full disk is reported to it. If this fails it does on every rank,
/// and there is no file. Collective.
PetscErrorCode write_shared_file(MPI_Comm comm, const std::string& path, int layout,
                                 const std::vector<Stretch>& stretches);

}  // namespace mpm
