#pragma once
// Reports of the run: failures in words, and figures for the log and the performance report.

#include "step/body_ids.hpp"
#include "step/step_context.hpp"
#include "step/timers.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class RunReports {
 public:
  RunReports(const StepContext<Space, T, Dim>& run, const BodyIds& ids) : run_(run), ids_(ids) {}

  /// Failure that a fault on this rank is: which particle, where, what happened; none without a fault.
  Failure failure_of(const Fault& fault) const;
  /// Failure where the limit of memory is too small for the batches of the soil.
  Failure failure_of_limit() const;

  /// Figures of all ranks; collective.
  std::vector<FunctionTime> times(const Timers& timers) const;
  std::optional<RankFigures> of_ranks() const;
  PetscErrorCode ownership(std::vector<OwnedPatch>* patches) const;
  int patches() const { return static_cast<int>(run_.sum_of(run_.state.patches.slots)); }
  std::size_t memory() const;  // bytes
  /// Line on the batches of the soil; stepping: wall time in steps [s].
  std::string of_batches(double stepping) const;

 private:
  /// Body of a particle on this rank; 0 where it is not here.
  std::size_t body_of(int id) const;

  const StepContext<Space, T, Dim>& run_;
  const BodyIds& ids_;
};

}  // namespace mpm
