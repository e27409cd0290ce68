#pragma once
// The stepper for one execution space, real type and dimension.

#include <cmath>
#include <string>

#include "download_nodes.hpp"
#include "grid_velocity.hpp"
#include "measure.hpp"
#include "save_state.hpp"
#include "step/step.hpp"
#include "step/stepper.hpp"
#include "upload.hpp"

namespace mpm {

/// Index in Materials of a model by its name, -1 if unknown.
int model_index(const std::string& name);

template <class Space, class T, int Dim>
class TypedStepper final : public Stepper {
 public:
  explicit TypedStepper(const Config& config) : config_(config) {}

  PetscErrorCode set_up(Model&& model, Failure* failure) override;
  PetscErrorCode advance(long steps, double dt, Batch* batch) override;
  PetscErrorCode rebuild(Failure* failure) override;
  void measure(double interval, HistoryRow* row) override;
  void snapshot(Snapshot* snapshot) override;
  SavedState save() const override { return save_state(state_); }
  PetscErrorCode restore(const SavedState& saved, long since_rebuild, bool* rebuilt) override;
  std::vector<FunctionTime> times() const override;
  long particles() const override { return state_.soil.points.count; }
  int patches() const override { return state_.patches.slots; }
  std::size_t memory() const override { return memory_of(state_); }
  std::string strategy() const override;

 private:
  Failure describe(const Fault& fault) const;

  Config config_;
  State<Space, T, Dim> state_;
  Timers timers_;
  long steps_enqueued_ = 0;
  std::vector<long> first_;  // id of the first particle of each body
};

}  // namespace mpm
