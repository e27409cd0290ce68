// The loop of a run: steps, rebuilds, output, and how it ends.

#include "run/run.hpp"

#include <algorithm>

#include "checkpoint/folder.hpp"
#include "common/text.hpp"
#include "output/history.hpp"
#include "run/dry_run.hpp"
#include "run/signals.hpp"
#include "run/stages.hpp"

namespace mpm {
namespace {

/// Steps after which domains follow the soil where no rebuild came: an elastic wave crosses some 200 cells.
constexpr long k_domain_steps = 512;

bool domains_follow(const Config& config) { return config.particle_domain != ParticleDomain::fixed; }

/// The signal that any rank has had to stop, or the time limit that is reached; empty if none. Collective.
PetscErrorCode find_stop(const Job& job, double born, std::string* stopped_by) {
  PetscFunctionBeginUser;
  constexpr int k_clock = 1 << 20;  // more than any signal
  const std::optional<double>& limit = job.config.output.wall_time_limit;
  int why = signal_caught();
  if (why == 0 && limit && seconds_now() - born >= *limit) why = k_clock;
  if (job.ranks() > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &why, 1, MPI_INT, MPI_MAX, job.comm));
  if (why != 0) *stopped_by = why == k_clock ? "-wall_time_limit" : name_of_signal(why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode Run::execute(const std::function<void()>& on_first_step) {
  PetscFunctionBeginUser;
  if (job_.config.dry_run) {
    PetscCall(dry_run(job_, time_step_, clock_));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(start());
  if (job_.outcome == Outcome::bad_input) PetscFunctionReturn(PETSC_SUCCESS);
  if (on_first_step) on_first_step();
  for (;;) {
    PetscCall(run_stage());
    if (job_.goes_well()) PetscCall(end_stage());
    if (!job_.goes_well() || !has_next_stage(job_, clock_)) break;
    PetscCall(next_stage());
  }
  PetscCall(finish());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps to the end of the stage, or of a run without stages.
PetscErrorCode Run::run_stage() {
  PetscFunctionBeginUser;
  const Schedule& schedule = clock_.schedule;
  while (job_.goes_well() && !clock_.is_at_end()) {
    PetscCall(time_step_.follow(job_, *stepper_, domains_changed(), clock_));
    if (!job_.goes_well()) break;
    PetscCall(advance_to(std::min(schedule.next_stop(clock_.step), time_step_.next_check(clock_))));
    if (!job_.goes_well()) break;
    if (schedule.row_in_turn(clock_.step)) PetscCall(write_row());
    if (!job_.goes_well()) break;
    PetscCall(outputs_.write_fields(job_, clock_, true, *stepper_));
    if (schedule.checkpoint_due(clock_.step)) PetscCall(write_checkpoint());
    if (!stopped_by_.empty() && (!clock_.is_at_end() || has_next_stage(job_, clock_))) PetscCall(stop());
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps up to `target`, in batches that end where the movement bound will probably ask for a rebuild. Where
/// domains change they end too, for the time step follows these.
PetscErrorCode Run::advance_to(long target) {
  PetscFunctionBeginUser;
  // s of wall time between two tests for a stop. On a device a test waits for the steps, which costs time.
  const double k_look_every = job_.config.backend == Backend::cuda ? 0.5 : 0.05;
  long estimate = 1, batch_limit = 1;
  while (clock_.step < target) {
    Batch batch;
    PetscCall(take_steps(batch_steps(target, std::min(std::max(estimate, 1L), batch_limit)), &batch));
    batch_limit = std::max(1L, static_cast<long>(k_look_every * batch.steps / std::max(batch.seconds, 1e-9)));
    estimate = batch.estimate;
    if (batch.failure.what.empty())
      PetscCall(prepare_steps(batch));
    else
      PetscCall(fail(job_, clock_, batch.failure.what));
    if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(job_.log.progress({clock_.step, clock_.time(), 0, end_of_run(job_, clock_), effort_.stepping,
                                 double(clock_.step) * stepper_->particles()}));
    std::string stopped_by;
    PetscCall(find_stop(job_, born_, &stopped_by));
    if (!stopped_by.empty()) stopped_by_ = stopped_by;
    if (!stopped_by.empty() || domains_changed()) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps of the next batch, of at most `wanted`: all have the same length, and no rebuild is due before the
/// last of them.
long Run::batch_steps(long target, long wanted) const {
  const std::optional<int>& forced = job_.config.p2g.rebuild_interval;
  const long since = effort_.rebuilds.since;
  long steps = std::min(target - clock_.step, wanted);
  if (forced) steps = std::min(steps, *forced - since);
  if (domains_follow(job_.config)) steps = std::min(steps, k_domain_steps - since % k_domain_steps);
  if (clock_.schedule.step_size(clock_.step) != clock_.dt) return 1;
  return std::min(steps, std::max(clock_.schedule.last_whole_step() - clock_.step, 1L));
}

PetscErrorCode Run::take_steps(long count, Batch* batch) {
  PetscFunctionBeginUser;
  StepRange range = clock_.schedule.range(clock_.step, count);
  range.before = clock_.last_dt;
  PetscCall(stepper_->advance(range, batch));
  if (batch->steps > 0) clock_.last_dt = range.dt;
  ++effort_.looks;
  effort_.stepping += batch->seconds;
  effort_.count_energy();
  clock_.step += batch->steps;
  effort_.rebuilds.since += batch->steps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rebuilds where that is due, or lets domains follow the soil.
PetscErrorCode Run::prepare_steps(const Batch& batch) {
  PetscFunctionBeginUser;
  const std::optional<int>& forced = job_.config.p2g.rebuild_interval;
  if (batch.rebuild || (forced && effort_.rebuilds.since >= *forced)) {
    PetscCall(rebuild(batch));
  } else if (domains_changed()) {
    const double before = seconds_now();
    PetscCall(stepper_->follow_soil());
    effort_.stepping += seconds_now() - before;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Whether domains change at this step, by a rebuild or because they follow the soil.
bool Run::domains_changed() const {
  return domains_follow(job_.config) && effort_.rebuilds.since % k_domain_steps == 0;
}

PetscErrorCode Run::rebuild(const Batch& batch) {
  PetscFunctionBeginUser;
  const std::optional<int>& forced = job_.config.p2g.rebuild_interval;
  auto& [since, count, longest, shortest] = effort_.rebuilds;
  if (forced && batch.rebuild && since < *forced) {
    PetscCall(fail(job_, clock_,
                   formatted("-p2g_rebuild_interval %d is unsafe: after %ld steps a particle can have moved "
                             "%.3g cells, and the lists hold for %.3g (-rebuild_margin)",
                             *forced, since, batch.bound, job_.config.p2g.margin)));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  shortest = count == 0 ? since : std::min(shortest, since);
  longest = std::max(longest, since);
  ++count;
  const double elapsed = clock_.time() - clock_.schedule.time_of(clock_.step - since);
  since = 0;
  Failure failure;
  const double before = seconds_now();
  PetscCall(stepper_->rebuild(elapsed, &failure));
  effort_.stepping += seconds_now() - before;
  if (const std::string notices = stepper_->drain_log(); !notices.empty())
    PetscCall(job_.log.print("step %ld: %s", clock_.step, notices.c_str()));
  if (!failure.what.empty()) PetscCall(fail(job_, clock_, failure.what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Run::write_row() {
  PetscFunctionBeginUser;
  PetscCall(outputs_.write_row(job_, clock_, effort_.wall(), *stepper_));
  clock_.stage.over = is_over(job_.config, clock_, outputs_.last_row());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Writes the row, the frame and the look for rasters at the end that a longer run would not have: a
/// checkpoint comes before them. A stage that ends without its event is a failure.
PetscErrorCode Run::end_stage() {
  PetscFunctionBeginUser;
  if (clock_.step > 0) {
    if (!clock_.schedule.row_in_turn(clock_.step)) PetscCall(write_row());
    PetscCall(outputs_.write_fields(job_, clock_, false, *stepper_));
  }
  if (job_.goes_well() && clock_.is_at_end() && !is_cut(job_.config, clock_))
    if (const std::string missed = missed_end(job_.config, clock_, outputs_.last_row()); !missed.empty())
      PetscCall(fail(job_, clock_, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Run::write_checkpoint() {
  PetscFunctionBeginUser;
  if (restarts_.written() == clock_.step) PetscFunctionReturn(PETSC_SUCCESS);
  const SignalsWait until_written;
  Checkpoint c = describe(job_, stepper_->strategy());
  c.run = {.step = clock_.step,
           .time = clock_.time(),
           .dt = clock_.dt,
           .dt_since = clock_.schedule.begin().step,
           .dt_since_time = clock_.schedule.begin().time,
           .last_dt = clock_.last_dt,
           .wall = effort_.wall(),
           .stepping = effort_.stepping,
           .rebuilds = effort_.rebuilds,
           .stage = clock_.stage,
           .waves = time_step_.waves()};
  PetscCall(outputs_.settle(job_, &c));
  PetscCall(stepper_->save(&c.state));
  PetscCall(restarts_.write(job_, clock_.step, std::move(c)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Run::stop() {
  PetscFunctionBeginUser;
  ignore_signals();
  PetscCall(write_checkpoint());
  job_.outcome = Outcome::stopped;
  PetscCall(job_.log.print("stopped by %s; %s is written, and -restart latest goes on from it",
                           stopped_by_.c_str(),
                           checkpoint_path(job_.config.output.directory, clock_.step).c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Run::finish() {
  PetscFunctionBeginUser;
  const OutputConfig& output = job_.config.output;
  PetscCall(outputs_.close(job_, *stepper_));
  if (job_.goes_well()) PetscCall(agree(job_.comm, restarts_.forget_later(job_, outputs_.frames())));
  if (output.energy) PetscCall(job_.log.line(format_energy(outputs_.last_row().energy)));
  PetscCall(report_performance(job_, performance_of(job_, clock_, effort_, *stepper_), *stepper_));
  PetscCall(job_.log.print("%s after %ld steps at time %g s; results are in %s", word_of(job_.outcome),
                           clock_.step, clock_.time(), output.directory.c_str()));
  PetscCall(agree(job_.comm, job_.log.close()));
  job_.lock.release();
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
