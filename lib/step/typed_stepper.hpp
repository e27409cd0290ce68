#pragma once
// The stepper for one execution space, real type and dimension: the order in which its parts work.

#include "step/applied_loads.hpp"
#include "step/energy_balance.hpp"
#include "step/history_measures.hpp"
#include "step/linked_rigids.hpp"
#include "step/mesh_sides.hpp"
#include "step/resampling.hpp"
#include "step/snapshots.hpp"
#include "step/soil_probes.hpp"
#include "step/step_loop.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class TypedStepper final : public Stepper {
 public:
  TypedStepper(const Config& config, MPI_Comm comm) : run_(config, comm) {}

  PetscErrorCode set_up(Model&& model, Failure* failure) override;
  PetscErrorCode advance(const StepRange& steps, Batch* batch) override;
  PetscErrorCode rebuild(double elapsed, Failure* failure) override;
  PetscErrorCode follow_soil() override;
  PetscErrorCode measure(double interval, HistoryRow* row) override;
  PetscErrorCode unbalanced_ratio(double time, double* ratio) override;
  PetscErrorCode keep_balance(const EnergyRow& before) override;
  PetscErrorCode begin_probes(ProbeState* state) override { return probes_.begin(state); }
  PetscErrorCode sum_sections(std::vector<SectionSum>* sums) override { return probes_.sum_sections(sums); }
  PetscErrorCode measure_probes(const ProbeState& state, std::vector<double>* values) override {
    return probes_.measure(state, values);
  }
  PetscErrorCode sum_columns(std::vector<long>* sums) override { return probes_.sum_columns(sums); }
  PetscErrorCode fastest_wave(double compression, double* speed) override {
    return measures_.fastest_wave(compression, speed);
  }
  PetscErrorCode closing_speed(double* speed) override { return measures_.closing_speed(speed); }
  PetscErrorCode snapshot(Snapshot* snapshot) override;
  PetscErrorCode ownership(std::vector<OwnedPatch>* patches) override { return reports_.ownership(patches); }
  std::string drain_log() override { return run_.ranks ? run_.ranks->drain_log() : ""; }
  std::optional<RankFigures> rank_figures() const override { return reports_.of_ranks(); }
  PetscErrorCode save(SavedState* saved) const override;
  PetscErrorCode restore(SavedState&& saved, long since_rebuild, bool* rebuilt) override;
  std::vector<FunctionTime> times() const override { return reports_.times(loop_.timers()); }
  long particles() const override { return ids_.particles(); }
  int patches() const override { return reports_.patches(); }
  std::size_t memory() const override { return reports_.memory(); }
  std::string strategy() const override { return word_of(chosen(run_.config.p2g.strategy)); }
  std::string bins_report() const override;
  std::string batches_report() const override { return reports_.of_batches(loop_.seconds()); }

 private:
  /// Length of the last step, or of the first one before it is done [s].
  double present_step() const;
  /// Copies options from the configuration to the state.
  void set_options(const Model& model);
  /// Decides, once for the run, between bins of cells and bins about nodes.
  void choose_bins(const std::vector<BodyInput>& bodies);
  /// Brings particles to new places and cells, merges and splits them, and makes the lists.
  PetscErrorCode sort_soil(double elapsed, Failure* failure);
  /// Checks that the state has taken a saved state of what the options describe. unfit: where it has not.
  PetscErrorCode check_saved(Failure unfit) const;

  StepContext<Space, T, Dim> run_;
  BodyIds ids_;
  RunReports<Space, T, Dim> reports_{run_, ids_};
  StepLoop<Space, T, Dim> loop_{run_, reports_};
  LinkedRigids<Space, T, Dim> links_{run_};
  AppliedLoads<Space, T, Dim> loads_{run_};
  MeshSides<Space, T, Dim> sides_{run_};
  EnergyBalance<Space, T, Dim> energy_{run_};
  SoilProbes<Space, T, Dim> probes_{run_};
  Resampling<Space, T, Dim> resampling_{run_, ids_};
  HistoryMeasures<Space, T, Dim> measures_{run_};
  Snapshots<Space, T, Dim> snapshots_{run_, ids_};
};

}  // namespace mpm
