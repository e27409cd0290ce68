#pragma once
// The time step behind one interface, whatever the backend, precision and dimension: the one place where what
// a user chose at run time becomes a template.

#include <petscsys.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/model.hpp"
#include "common/snapshot.hpp"
#include "data/saved_state.hpp"
#include "mpm/config.hpp"
#include "output/performance.hpp"
#include "output/probes.hpp"

namespace mpm {

/// Why the run cannot go on.
struct Failure {
  std::string what;  // a sentence: which particle, where, what happened; empty if all is well
};

/// Steps to do. Step k of them begins at origin + (first + k) dt: at the same bits for the tables in time,
/// wherever a batch began.
struct StepRange {
  long count = 0;
  double time = 0, dt = 0;  // s, before the first of them; length of each
  double origin = 0;        // s
  long first = 0;
  double before = 0;  // s, length of the step before them; 0: they are the first of the run
};

/// Result of a batch of steps.
struct Batch {
  long steps = 0;        // done
  bool rebuild = false;  // the movement bound passed the margin: rebuild before the next step
  long estimate = 1;     // steps that the bound will probably still allow
  double bound = 0;      // cells
  double seconds = 0;    // of wall time, on the slowest rank
  Failure failure;
};

/// A patch that holds particles.
struct OwnedPatch {
  std::array<int, 3> place{};  // along each direction, from 0 at the mesh's lower corner
  int particles = 0, rank = 0;
};

/// The time step of all ranks together: every function but `strategy` is collective, and its results are
/// those of all ranks.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Puts the particles on the device and orders them.
  virtual PetscErrorCode set_up(Model&& model, Failure* failure) = 0;
  /// Does up to `steps.count` steps, and fewer if a rebuild or a failure comes first, or if the device turns
  /// out not to hold a launch of many.
  virtual PetscErrorCode advance(const StepRange& steps, Batch* batch) = 0;
  /// Bins, patches and lists anew, and the correction of positions. elapsed: time since the last rebuild [s].
  virtual PetscErrorCode rebuild(double elapsed, Failure* failure) = 0;
  /// Domains that stretch follow the soil, as at a rebuild; lists stay. Between two steps, with no rebuild
  /// due.
  virtual PetscErrorCode follow_soil() = 0;
  /// Rows of the history at row->time; `interval` [s] is the time since the last call, over which the forces
  /// are a mean.
  virtual PetscErrorCode measure(double interval, HistoryRow* row) = 0;
  /// Mean unbalanced force over mean weight of the nodes, at a time [s]; infinite where no node is
  /// free.
  virtual PetscErrorCode unbalanced_ratio(double time, double* ratio) = 0;
  /// Finds the state of the probes at the start of the run, the same on every rank.
  virtual PetscErrorCode begin_probes(ProbeState* state) = 0;
  /// Sums the soil beyond the sections, with soil that has left there, and the fluxes; over all ranks.
  virtual PetscErrorCode sum_sections(std::vector<SectionSum>* sums) = 0;
  /// The columns of all probes in a row of the history.
  virtual PetscErrorCode measure_probes(const ProbeState& state, std::vector<double>* values) = 0;
  /// The sums of the columns of the rasters (column_sums.hpp), of all ranks.
  virtual PetscErrorCode sum_columns(std::vector<long>* sums) = 0;
  /// Speed of the fastest wave in the soil [m/s], once the soil has been compressed by a volume strain.
  virtual PetscErrorCode fastest_wave(double compression, double* speed) = 0;
  /// At most, the speed [m/s] at which opposite sides of a cell close in: what the velocities of soil, rigid
  /// bodies and sides differ by, summed over the axes.
  virtual PetscErrorCode closing_speed(double* speed) = 0;
  /// The frame at snapshot->time; on several ranks each has a range of the particles of a body.
  virtual PetscErrorCode snapshot(Snapshot* snapshot) = 0;
  /// Rows of partition.csv, on rank 0: the patches that hold particles, with these and their rank.
  virtual PetscErrorCode ownership(std::vector<OwnedPatch>* patches) = 0;
  /// After the soil was changed between two steps: the energy balance goes on with what is dissipated and
  /// what the update takes as they were in `before`. Collective.
  virtual PetscErrorCode keep_balance(const EnergyRow& before) = 0;
  /// Lines for the log on the rebuilds since the last call.
  virtual std::string drain_log() = 0;
  /// None on one rank. Collective.
  virtual std::optional<RankFigures> rank_figures() const = 0;
  /// All that this rank's part of the state is, between two steps, with no rebuild due.
  /// Collective.
  virtual PetscErrorCode save(SavedState* saved) const = 0;
  /// Puts a saved state in the place of what set_up made from the same input. `rebuilt`: it was saved for
  /// lists of another margin, so that bins and lists had to be made anew.
  virtual PetscErrorCode restore(SavedState&& saved, long since_rebuild, bool* rebuilt) = 0;
  virtual std::vector<FunctionTime> times() const = 0;
  virtual long particles() const = 0;           // of the soil
  virtual int patches() const = 0;              // active ones
  virtual std::size_t memory() const = 0;       // bytes on the device
  virtual std::string strategy() const = 0;     // the word of -p2g that runs
  virtual std::string bins_report() const = 0;  // bins about nodes; empty without them
  /// Line for the log on the batches of -device_memory_limit, and on their cost so far.
  virtual std::string batches_report() const = 0;
};

/// The stepper for config.backend, precision and dim on the ranks of comm; null where that is not compiled
/// in.
std::unique_ptr<Stepper> make_stepper(const Config& config, MPI_Comm comm = PETSC_COMM_SELF);

/// The backends compiled in, the slowest first.
std::vector<Backend> available_backends();
const char* word_of(Backend backend);
const char* word_of(Precision precision);

/// Speed of the P wave in a body [m/s], where it is stiffest.
double wave_speed(const Config& config, const BodyConfig& body);

/// Largest stable step over the Courant number: spacing / fastest wave [s] (Eq. 14), of the soil as it is
/// created.
double critical_time_step(const Config& config);

/// Largest stable step [s] of what laws add to the waves, as an explicit viscosity (largest_time_step of
/// materials/any.hpp); infinite where no law adds anything.
double viscous_time_step(const Config& config);

/// Whether the stiffness of some body depends on stress or state: the time step follows what
/// Stepper::fastest_wave gives.
bool stiffness_changes(const Config& config);

/// Version of Kokkos, and the name of the device that the backend runs on.
std::string kokkos_version();
std::string device_name(Backend backend);

/// Threads of this process that run the backend's kernels; on a GPU the one that starts them.
int thread_count(Backend backend);

/// Bytes read and written per second by a copy on the device of a backend, measured now [bytes/s]; 0 if it
/// cannot be.
double copy_bandwidth(Backend backend);

}  // namespace mpm
