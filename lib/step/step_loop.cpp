#include "step/step_loop.hpp"

#include "common/text.hpp"
#include "functions/step_kernels.hpp"
#include "step/body_input.hpp"
#include "step/schedule.hpp"

namespace mpm {

template <class Space, class T, int Dim>
PetscErrorCode StepLoop<Space, T, Dim>::set_up(bool from_run) {
  PetscFunctionBeginUser;
  from_run_ = from_run;
  PetscCall(timers_.create());
  timers_.sample(!is_device<Space>);
  const Config& config = run_.config;
  if (!(config.rayleigh_mass > 0 || config.rayleigh_stiffness > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  rayleigh_ = std::make_unique<Rayleigh<Space, T, Dim>>();
  run_.state.scheme.rayleigh = true;
  begin_rayleigh(*rayleigh_, config.rayleigh_mass, config.rayleigh_stiffness, shear_ratios(config));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode StepLoop<Space, T, Dim>::advance(const StepRange& range, Batch* batch) {
  PetscFunctionBeginUser;
  auto& s = run_.state;
  const double dt = step_size_ = range.dt;
  // Velocities are means over a step: from one to the next they change by half of each step's length, and
  // from rest by half of the first step's.
  const double before = range.before > 0 || !from_run_ ? range.before : dt;
  s.scheme.kick = before == dt ? 1 : (before + dt) / (2 * dt);
  s.time = range.time;
  begin_loads(s, s.timed, {range.origin - run_.config.time.start, dt, range.first, before});
  const double start = WorkClock::wall();
  restart_count(s);
  if (run_.ranks)
    PetscCall(advance_together(range.count, batch));
  else
    PetscCall(advance_alone(range.count, batch));
  batch->seconds = WorkClock::wall() - start;
  if (!run_.ranks) seconds_ += batch->seconds;
  PetscCall(run_.largest(&batch->seconds));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode StepLoop<Space, T, Dim>::advance_alone(long steps, Batch* batch) {
  PetscFunctionBeginUser;
  while (steps > 0) {
    long done = 0;
    PetscCall(do_steps(steps, &done));
    steps -= done;
  }
  join();
  const Control control = read_control(run_.state);
  if constexpr (is_device<Space>)
    if ((control.paused & Pause::not_co_resident) != 0) resume_single_steps(run_.state);
  batch->steps = control.steps;
  batch->bound = control.bound;
  batch->failure = control.fault_count > 0 ? reports_.failure_of(control.fault) : Failure{};
  batch->rebuild = (control.paused & Pause::due) != 0 && control.fault_count == 0;
  batch->estimate = steps_to_rebuild(control, batch->rebuild);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps until all are done, or until the ranks agree, all at the same step, that lists must be rebuilt or
/// that one of them cannot go on. Their reports of each other are some steps old; a rank whose bound has
/// passed the margin does no more steps, so that no particle is ever looked for where it is not. Soil that is
/// so fast that it may cross the margin in as many steps is checked after each of them, and so is the first
/// step of all.
template <class Space, class T, int Dim>
PetscErrorCode StepLoop<Space, T, Dim>::advance_together(long steps, Batch* batch) {
  PetscFunctionBeginUser;
  WorkClock& clock = run_.ranks->clock();
  if (is_swift(last_increment_)) steps = 1;
  clock.go_on();
  long done = 0;
  bool due = false;
  while (done < steps && !due) PetscCall(step_together(&steps, &done, &due));
  join();
  const Control own = read_control(run_.state);
  clock.pause();
  const bool missed = own.steps != done;
  BoundReport now{own.bound, own.increment, own.fault_count > 0 || missed ? 1.0 : 0.0};
  PetscCall(GlobalBound::now(run_.comm, &now));
  last_increment_ = now.increment;
  clock.go_on();
  clock.stop();
  batch->steps = done;
  batch->bound = now.bound;
  batch->estimate = std::numeric_limits<long>::max();  // the batch ends by itself
  batch->failure = {};
  if (now.stopped > 0) PetscCall(stop_together(own, missed, batch));
  // Where a batch ends must not matter, so the present bound decides nothing but with a forced interval, and
  // that the margin is passed: soil for which that can be is checked after each step.
  const bool beyond = rebuild_due(now.bound, 0, run_.config.p2g.margin, 0);
  batch->rebuild = batch->failure.what.empty() && (beyond || (late() > 0 && due));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Does a step, and sets whether a rebuild is due then. Where the soil is swift it is the last one of
/// `steps`.
template <class Space, class T, int Dim>
PetscErrorCode StepLoop<Space, T, Dim>::step_together(long* steps, long* done, bool* due) {
  PetscFunctionBeginUser;
  long one = 0;
  PetscCall(do_steps(1, &one));
  ++*done;
  BoundReport all;
  bool known = false;
  PetscCall(run_.ranks->look_back(&known, &all));
  // A report without a bound is of a step before the lists were built.
  const bool passed = late() > 0 && known && all.bound > 0 &&
                      rebuild_due(all.bound, all.increment, run_.config.p2g.margin, late());
  *due = run_.ranks->count_down() || passed || (known && all.stopped > 0);
  if (known && is_swift(all.increment)) *steps = *done;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A batch in which some rank stopped. missed: this rank did fewer steps than the others.
template <class Space, class T, int Dim>
PetscErrorCode StepLoop<Space, T, Dim>::stop_together(const Control& own, bool missed, Batch* batch) const {
  PetscFunctionBeginUser;
  batch->steps = own.steps;
  PetscCall(run_.least(&batch->steps));
  if (own.fault_count > 0)
    batch->failure = reports_.failure_of(own.fault);
  else if (missed && !run_.config.p2g.rebuild_interval)
    batch->failure.what = formatted(
        "a particle moved %.3g cells since the last rebuild, and the lists hold for %.3g: its speed grew "
        "more "
        "than by half while the ranks exchanged their bounds; lower -time_courant or -rebuild_margin",
        own.bound, run_.config.p2g.margin);
  PetscCall(run_.share(&batch->failure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Does at most so many steps, in one launch where that can do several.
template <class Space, class T, int Dim>
PetscErrorCode StepLoop<Space, T, Dim>::do_steps(long most, long* done) {
  PetscFunctionBeginUser;
  sample(true);
  most = std::min(most, until_sample());
  long left = most;
  PetscCall(step<Space, T, Dim>(run_.state, timers_, step_size_, run_.ranks.get(),
                                is_device<Space> ? &overlap_ : nullptr, &left, rayleigh_.get()));
  sample(false);
  *done = most - left;
  steps_enqueued_ += *done;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Before a step on a device: whether it is one of those that are timed. After it: none is. They are step 20,
/// 40, 80 ... of the run, later each k_apart: a step that is timed takes longer, in a small problem as long
/// as ten.
template <class Space, class T, int Dim>
void StepLoop<Space, T, Dim>::sample(bool on) {
  constexpr long k_apart = 5000;
  if (!is_device<Space>) return;
  const bool due = on && steps_enqueued_ == next_sample_ - 1;
  if (due) {
    next_sample_ += std::min(next_sample_, k_apart);
    join();
    run_.state.space.fence("mpm::before a step that is timed");
  }
  timers_.sample(due);
}

/// Steps that the movement bound will probably still allow, of soil that accelerates as it did since the host
/// last read the bound. rebuilt: the bound begins anew.
template <class Space, class T, int Dim>
long StepLoop<Space, T, Dim>::steps_to_rebuild(const Control& control, bool rebuilt) {
  if (control.steps > 0) growth_ = (control.increment - seen_increment_) / control.steps;
  seen_increment_ = control.increment;
  const double left = run_.config.p2g.margin - (rebuilt ? 0 : control.bound);
  return static_cast<long>(std::min(steps_to_move(left, control.increment, growth_), 1e9)) + 1;
}

#define MPM_INSTANTIATE(Space, T, Dim) template class StepLoop<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
