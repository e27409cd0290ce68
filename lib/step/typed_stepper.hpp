#pragma once
// The stepper for one execution space, real type and dimension.

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "common/material_table.hpp"
#include "functions/energy_works.hpp"
#include "functions/find_strays.hpp"
#include "functions/grid_velocity.hpp"
#include "functions/position_correction.hpp"
#include "functions/step_kernels.hpp"
#include "functions/wall_force.hpp"
#include "parallel/kept_by_id.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/merge_particles.hpp"
#include "rebuild/split_particles.hpp"
#include "step/present_rigids.hpp"
#include "step/step.hpp"
#include "step/stepper.hpp"
#include "transfer/download.hpp"
#include "transfer/download_nodes.hpp"
#include "transfer/measure.hpp"
#include "transfer/save_state.hpp"
#include "transfer/section_sums.hpp"
#include "transfer/unbalanced.hpp"
#include "transfer/upload.hpp"
#include "transfer/upload_sides.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class TypedStepper final : public Stepper {
 public:
  TypedStepper(const Config& config, MPI_Comm comm)
      : rigids_(config), config_(rigids_.narrowed(config)), comm_(comm) {
    state_.space = space_of<Space>(config.backend);
  }

  PetscErrorCode set_up(Model&& model, Failure* failure) override;
  PetscErrorCode advance(const StepRange& steps, Batch* batch) override;
  PetscErrorCode rebuild(double elapsed, Failure* failure) override;
  PetscErrorCode follow_soil() override;
  PetscErrorCode measure(double interval, HistoryRow* row) override;
  PetscErrorCode unbalanced_ratio(double time, double* ratio) override;
  PetscErrorCode keep_balance(const EnergyRow& before) override;
  PetscErrorCode begin_probes(ProbeState* state) override;
  PetscErrorCode sum_sections(std::vector<SectionSum>* sums) override;
  PetscErrorCode measure_probes(const ProbeState& state, std::vector<double>* values) override;
  PetscErrorCode sum_columns(std::vector<long>* sums) override;
  PetscErrorCode fastest_wave(double compression, double* speed) override;
  PetscErrorCode closing_speed(double* speed) override;
  PetscErrorCode snapshot(Snapshot* snapshot) override;
  PetscErrorCode ownership(std::vector<OwnedPatch>* patches) override;
  std::string drain_log() override { return ranks_ ? ranks_->drain_log() : ""; }
  std::optional<RankFigures> rank_figures() const override;
  PetscErrorCode save(SavedState* saved) const override;
  PetscErrorCode restore(SavedState&& saved, long since_rebuild, bool* rebuilt) override;
  std::vector<FunctionTime> times() const override;
  long particles() const override;
  int patches() const override { return static_cast<int>(sum_over_ranks(state_.patches.slots)); }
  std::size_t memory() const override;
  std::string strategy() const override;
  std::string batches_report() const override;

 private:
  Failure describe(const Fault& fault) const;
  std::size_t body_of(int id) const;
  /// Why the soil cannot go in batches, if it should and cannot.
  Failure too_small() const;
  /// Advance and rebuild on several ranks.
  PetscErrorCode advance_together(long steps, double dt, Batch* batch);
  PetscErrorCode rebuild_together(double elapsed, Failure* failure);
  /// The failure of the lowest rank that has one, on every rank.
  PetscErrorCode share(Failure* failure) const;
  PetscErrorCode sum_soil();
  /// Work for sides of the mesh that act: at the start, before steps, for a row, around a rebuild on several
  /// ranks, and for checkpoints.
  void set_up_sides(GridInput* grid);
  PetscErrorCode begin_sides();
  PetscErrorCode measure_sides(double interval, HistoryRow* row);
  PetscErrorCode gather_sides(std::vector<double>* table) const;
  PetscErrorCode save_sides(SavedSides* saved) const;
  PetscErrorCode restore_sides(const SavedSides& saved);
  PetscErrorCode find_own_sides(std::vector<int>* own) const;
  PetscErrorCode put_sides(const std::vector<double>& table);
  PetscErrorCode take_probe_particles(const ProbeState& state, std::vector<ProbeParticle>* particles);
  /// Before and after locate(), for sections: which particles are beyond them, and which of these have left.
  BeyondMask<Space> mark_beyond();
  void note_all_lost(const BeyondMask<Space>& beyond);
  PetscErrorCode save_sections(SavedState* saved) const;
  void restore_sections(const SavedState& saved);
  void set_gravity(double time);
  /// Work for loads on surfaces: at the start, for measures at a time, for a row, and for checkpoints.
  void set_up_loads(const Model& model);
  void set_loads(double time);
  PetscErrorCode measure_loads(HistoryRow* row) const;
  PetscErrorCode load_work(double* work) const;
  void restore_load_work(double work);
  PetscErrorCode measure_body(int body, BodyRow* row);
  PetscErrorCode begin_energy();
  PetscErrorCode measure_energy(HistoryRow* row);
  PetscErrorCode count_cells(HistoryRow* row) const;
  PetscErrorCode save_energy(SavedState* saved) const;
  void restore_energy(const SavedState& saved);
  PetscErrorCode note_out_of_order(int body, BodyRow* row);
  PetscErrorCode gather_strays(SavedState* saved) const;
  double sum_over_ranks(double own) const;
  PetscErrorCode keep_heights(const Model& model);
  /// Merges particles that crowd, and splits those whose domains have become too long, where the run asks for
  /// it. Collective.
  PetscErrorCode split_and_merge();
  void set_up_correction();
  void set_up_rayleigh();
  /// Moves particles to an even density, where the run asks for it, after lists were made. elapsed: time
  /// since the correction before [s]. Collective.
  PetscErrorCode correct_positions(double elapsed);
  /// Ids that have been given to particles of all ranks.
  long ids() const { return total_ + children_; }
  /// Leaves particles out that are not in the run; their ids stay theirs.
  PetscErrorCode leave_out(Model* model);
  /// Which fields of the saved soil hold the state variables of which law.
  void name_columns(SavedState* saved) const;
  /// Saves the fields that a start from a checkpoint needs beside those of a restart.
  PetscErrorCode save_for_starts(SavedState* saved) const;
  double velocity_of(std::size_t rigid, int d, double present, double time) const;
  void sample(bool on);
  long until_sample() const;
  long steps_to_rebuild(const Control& control, bool rebuilt);

  PresentRigids rigids_;
  Config config_;  // of the rigids that are there
  MPI_Comm comm_;
  State<Space, T, Dim> state_;
  std::unique_ptr<Decomposition<Space, T, Dim>> ranks_;  // null on one rank
  OverlapStream<Space> overlap_;
  std::unique_ptr<Rayleigh<Space, T, Dim>> rayleigh_;  // null without such damping
  Timers timers_;
  long steps_enqueued_ = 0, next_sample_ = 20;
  double seen_increment_ = 0;  // of the movement bound, when the host looked last [cells]
  double growth_ = 0;          // of the increment a step [cells]
  double stepping_ = 0;        // s of wall time in advance
  double step_ = 0;            // s, length of the last step
  bool goes_on_ = false;       // the soil starts from another run, with the velocities of its last step
  double last_increment_ = std::numeric_limits<double>::infinity();  // cells, of all ranks, of the last batch
  std::vector<long> first_;                                          // id of the first particle of each body
  std::vector<long> unused_;                            // ids of each body that no particle has had
  long total_ = 0;                                      // particles of all ranks at the start
  long children_ = 0;                                   // that splitting has added, on all ranks
  double kinetic_at_start_ = 0, elastic_at_start_ = 0;  // J, of all ranks, where there is an energy balance
  std::vector<SectionPlane> planes_;                    // of the sections among the probes
  std::vector<SectionSum> lost_beyond_;                 // by plane: what has left there, on this rank
  KeptById heights_;                                    // m, absolute, where each particle was created
};

}  // namespace mpm
