#pragma once
// What a checkpoint holds, and its file: checkpoint_STEP.h5, one HDF5 file with a line behind it that tells
// its length and checksum. Particles are in the order of their creation, whatever rank had them, so that any
// number of ranks can go on from it.

#include <petscsys.h>

#include <cstdint>
#include <string>
#include <vector>

#include "input/options.hpp"
#include "output/history.hpp"
#include "saved_state.hpp"

namespace mpm {

/// Where a run is, beside its particles.
struct RunState {
  long step = 0;
  double time = 0, dt = 0;                                          // s, simulated; of a whole step
  double last_row_time = 0;                                         // s, simulated
  double wall = 0, stepping = 0;                                    // s since the first step; of it in steps
  long since_rebuild = 0, rebuilds = 0, longest = 0, shortest = 0;  // steps between rebuilds
};

/// Which particles of one set a rank holds of a checkpoint: `count` from number `first`, of `total`.
struct IdBlock {
  long first = 0, count = 0, total = 0;
};

struct Checkpoint {
  std::string version;  // of the program
  int dim = 2, ranks = 1;
  std::string backend, precision, strategy;  // words of the options
  std::vector<EffectiveOption> options;      // in force
  RunState run;
  HistoryMark history;
  long frames = 0;  // written so far
  SavedState state;
};

/// Writes the file under a temporary name, brings it to the disk, reads it again to compare its checksum, and
/// renames it to `path`. Collective; each rank gives the points that it has, in any order. A former `path` is
/// whole until the new one is, and so is every other file if this fails.
PetscErrorCode write_checkpoint(MPI_Comm comm, const std::string& path, Checkpoint&& checkpoint);

/// Reads a file, each rank its block of the points of every set, by number. Collective. `fault` is what a
/// file that can be gone on from would be ("takes ..."), and empty if this is one; nothing of a file whose
/// checksum is wrong is looked at.
PetscErrorCode read_checkpoint(MPI_Comm comm, const std::string& path, Checkpoint& checkpoint,
                               std::string* fault);

/// The same of a file whose seal is known to be right, on one of `ranks` ranks.
std::string read_items(const std::string& path, int rank, int ranks, Checkpoint& checkpoint);

}  // namespace mpm
