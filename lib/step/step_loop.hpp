#pragma once
// Batches of steps: their end, their pace on the device, and their times.

#include <algorithm>
#include <limits>

#include "step/run_reports.hpp"
#include "step/step.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class StepLoop {
 public:
  StepLoop(StepContext<Space, T, Dim>& run, const RunReports<Space, T, Dim>& reports)
      : run_(run), reports_(reports) {}

  /// Makes the timers, and Rayleigh damping where the run asks for it. from_run: the soil starts from another
  /// run, with the velocities of its last step.
  PetscErrorCode set_up(bool from_run);
  /// Does a batch of steps. Collective.
  PetscErrorCode advance(const StepRange& range, Batch* batch);
  /// Work on the main stream from now on waits for the overlap stream.
  void join() { overlap_.join(run_.state.space); }
  Timers& timers() { return timers_; }
  const Timers& timers() const { return timers_; }
  /// Length of the last step, 0 before it; wall time in steps on one rank [s].
  double step_size() const { return step_size_; }
  double seconds() const { return seconds_; }

 private:
  PetscErrorCode advance_alone(long steps, Batch* batch);
  PetscErrorCode advance_together(long steps, Batch* batch);
  PetscErrorCode step_together(long* steps, long* done, bool* due);
  PetscErrorCode stop_together(const Control& own, bool missed, Batch* batch) const;
  PetscErrorCode do_steps(long most, long* done);
  void sample(bool on);
  /// Steps up to the next one that is timed, or that one.
  long until_sample() const { return std::max(1L, next_sample_ - 1 - steps_enqueued_); }
  long steps_to_rebuild(const Control& control, bool rebuilt);
  /// Steps by which reports of other ranks are late; 0 with a forced interval, which has no reserve.
  int late() const { return run_.config.p2g.rebuild_interval ? 0 : GlobalBound::k_late; }
  /// Whether soil may cross the margin before the reports of a step are there. increment [cells]: of a step.
  bool is_swift(double increment) const {
    constexpr double k_growth = 2;  // of the speeds till then
    return late() > 0 && !(k_growth * (late() + 1) * increment < run_.config.p2g.margin);
  }

  StepContext<Space, T, Dim>& run_;
  const RunReports<Space, T, Dim>& reports_;
  OverlapStream<Space> overlap_;
  std::unique_ptr<Rayleigh<Space, T, Dim>> rayleigh_;  // null without such damping
  Timers timers_;
  long steps_enqueued_ = 0, next_sample_ = 20;
  double seen_increment_ = 0;  // cells, of the movement bound, when the host last read it
  double growth_ = 0;          // cells, of the increment a step
  double last_increment_ = std::numeric_limits<double>::infinity();  // cells, of all ranks, of the last batch
  double step_size_ = 0, seconds_ = 0;
  bool from_run_ = false;
};

}  // namespace mpm
