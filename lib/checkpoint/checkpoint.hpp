#pragma once
// The content of a checkpoint and its file, checkpoint_STEP.h5. The file is an HDF5 file, followed by a line
// with its length and checksum. Particles are in the order of their creation on any number of ranks, so that
// any number of ranks can continue from it.

#include <petscsys.h>

#include <cstdint>
#include <string>
#include <vector>

#include "data/saved_state.hpp"
#include "input/deck/report.hpp"
#include "output/history.hpp"
#include "output/probes.hpp"
#include "output/rasters.hpp"

namespace mpm {

/// Schedule of the computation of wave speeds, where the time step follows the stiffness of the soil.
struct WaveWatch {
  long due = 0, every = 1;  // step of the next look; steps from the last one to it
  double speed = 0;         // m/s, of the fastest wave at the last look; 0: there was none
};

/// Steps between rebuilds: since the last one, how many there were, and the most and fewest between two.
struct RebuildCount {
  long since = 0, count = 0, longest = 0, shortest = 0;
};

/// The present stage of a run.
struct StageState {
  long index = 0, step = 0;                     // among the stages; step at its begin
  double time = 0;                              // s, simulated, at its begin
  int over = 0;                                 // 1: the event that ends it has come
  std::vector<double> rigid_zero, rigid_begin;  // m, 3 a rigid: displacements that the history counts from,
                                                // and those at the begin of the stage; empty: 0
};

/// The progress of a run.
struct RunState {
  long step = 0;
  double time = 0, dt = 0;        // s, simulated; of a whole step
  long dt_since = 0;              // the step from which steps have been of dt
  double dt_since_time = 0;       // s, simulated, before that step
  double last_dt = 0;             // s, of the step before; 0: there is none
  double last_row_time = 0;       // s, simulated
  double wall = 0, stepping = 0;  // s since the first step; of it in steps
  RebuildCount rebuilds;
  StageState stage;
  WaveWatch waves;
};

/// The particles of one set of a checkpoint that a rank holds: `count` of `total`, from number `first` on.
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
  ProbeState probes{};
  Rasters rasters{};
};

/// Writes the file under a temporary name, flushes it to the disk, reads it again to compare its checksum,
/// and renames it to `path`. Collective; each rank gives its own points, in any order. An earlier file of
/// this name stays complete until the new one is complete. If writing fails, all other files stay complete.
PetscErrorCode write_checkpoint(MPI_Comm comm, const std::string& path, Checkpoint&& checkpoint);

/// Reads a file; each rank reads its block of the points of every set, by number. Collective. `fault` is the
/// end of the message "takes ..." where the run cannot continue from the file, else empty. If the checksum is
/// wrong, the content is not read.
PetscErrorCode read_checkpoint(MPI_Comm comm, const std::string& path, Checkpoint& checkpoint,
                               std::string* fault);

/// Fault of the state for this mesh and these bodies ("takes ..."); empty if there is none.
std::string state_fault(const SavedState& state, const Config& config);

/// These words are in what is kept of a file that gives each particle its own value of a parameter.
inline std::string own_parameter_words(const std::string& parameter) {
  return ", with " + parameter + " of each particle";
}

/// Reads a file whose seal has been checked, as one of `ranks` ranks.
std::string read_items(const std::string& path, int rank, int ranks, Checkpoint& checkpoint);

}  // namespace mpm
