// The run: steps, rebuilds, output, and how it ends.

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "common/collectives.hpp"
#include "common/text.hpp"
#include "output/files.hpp"
#include "output/performance_json.hpp"
#include "simulation_body.hpp"

namespace mpm {
namespace {

const char* word_of(Outcome outcome) {
  return outcome == Outcome::finished ? "finished" : outcome == Outcome::stopped ? "stopped" : "failed";
}

}  // namespace

PetscErrorCode Simulation::run() {
  PetscFunctionBeginUser;
  Body& b = *body_;
  if (b.is_element()) {
    PetscCall(b.run_element());
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (b.config.dry_run) {
    PetscCall(b.dry_run());
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(b.start());
  if (b.outcome == Outcome::bad_input) PetscFunctionReturn(PETSC_SUCCESS);
  if (b.on_first_step) b.on_first_step();
  for (;;) {
    PetscCall(b.run_stage());
    if (b.outcome == Outcome::finished) PetscCall(b.end_stage());
    if (b.outcome != Outcome::finished || !b.has_next_stage()) break;
    PetscCall(b.next_stage());
  }
  PetscCall(b.finish());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps to the end of the stage, or of a run without stages.
PetscErrorCode Simulation::Body::run_stage() {
  PetscFunctionBeginUser;
  while (outcome == Outcome::finished && !stage_over && step < schedule.last_step()) {
    PetscCall(follow_stiffness());
    if (outcome != Outcome::finished) break;
    PetscCall(advance_to(std::min(schedule.next_stop(step), next_stiffness_check())));
    if (outcome != Outcome::finished) break;
    if (schedule.row_in_turn(step)) PetscCall(write_row());
    if (outcome != Outcome::finished) break;
    if (schedule.raster_in_turn(step)) PetscCall(update_rasters());
    if (schedule.frame_in_turn(step)) PetscCall(write_frame());
    if (schedule.checkpoint_due(step)) PetscCall(write_checkpoint());
    if (!stopped_by.empty() && ((step < schedule.last_step() && !stage_over) || has_next_stage()))
      PetscCall(stop());
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::fail(const std::string& what) {
  PetscFunctionBeginUser;
  outcome = Outcome::failed;
  char place[80];
  std::snprintf(place, sizeof place, "mpm: step %ld, time %.9g s: ", step, schedule.time_of(step));
  PetscCall(log.error(place + what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps up to `target`, in batches that end where the movement bound will probably ask for a rebuild. Where
/// domains change they end too, for the time step follows these.
PetscErrorCode Simulation::Body::advance_to(long target) {
  PetscFunctionBeginUser;
  // s of wall time between two tests for a stop. On a device a test waits for the steps, which costs time.
  const double k_look_every = config.backend == Backend::cuda ? 0.5 : 0.05;
  long estimate = 1, batch_limit = 1;
  while (step < target) {
    long steps = std::min({target - step, std::max(estimate, 1L), batch_limit});
    if (config.p2g.rebuild_interval) steps = std::min(steps, *config.p2g.rebuild_interval - since_rebuild);
    if (domains_follow()) steps = std::min(steps, k_domain_steps - since_rebuild % k_domain_steps);
    const double step_dt = schedule.step_size(step);
    if (step_dt == dt)
      steps = std::min(steps, std::max(schedule.last_whole_step() - step, 1L));
    else
      steps = 1;
    Batch batch;
    StepRange range = schedule.range(step, steps);
    range.before = last_dt;
    PetscCall(stepper->advance(range, &batch));
    if (batch.steps > 0) last_dt = range.dt;
    ++looks;
    const double took = batch.seconds;
    stepping += took;
    batch_limit = std::max(1L, static_cast<long>(k_look_every * batch.steps / std::max(took, 1e-9)));
    estimate = batch.estimate;
    step += batch.steps;
    since_rebuild += batch.steps;
    if (!batch.failure.what.empty()) {
      PetscCall(fail(batch.failure.what));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    if (batch.rebuild || (config.p2g.rebuild_interval && since_rebuild >= *config.p2g.rebuild_interval))
      PetscCall(rebuild(batch));
    else if (domains_changed())
      PetscCall(follow_soil());
    if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(log.progress(
        {step, schedule.time_of(step), 0, end_of_run(), stepping, double(step) * stepper->particles()}));
    bool stop = false;
    PetscCall(look_for_stop(&stop));
    if (stop || domains_changed()) PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

bool Simulation::Body::domains_follow() const { return config.particle_domain != ParticleDomain::fixed; }
bool Simulation::Body::domains_changed() const {
  return domains_follow() && since_rebuild % k_domain_steps == 0;
}

PetscErrorCode Simulation::Body::follow_soil() {
  PetscFunctionBeginUser;
  const double before = seconds_now();
  PetscCall(stepper->follow_soil());
  stepping += seconds_now() - before;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::rebuild(const Batch& batch) {
  PetscFunctionBeginUser;
  const std::optional<int>& forced = config.p2g.rebuild_interval;
  if (forced && batch.rebuild && since_rebuild < *forced) {
    char what[300];
    std::snprintf(what, sizeof what,
                  "-p2g_rebuild_interval %d is unsafe: after %ld steps a particle can have moved %.3g cells, "
                  "and the lists hold for "
                  "%.3g (-rebuild_margin)",
                  *forced, since_rebuild, batch.bound, config.p2g.margin);
    PetscCall(fail(what));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  shortest = rebuilds == 0 ? since_rebuild : std::min(shortest, since_rebuild);
  longest = std::max(longest, since_rebuild);
  ++rebuilds;
  const double elapsed = schedule.time_of(step) - schedule.time_of(step - since_rebuild);
  since_rebuild = 0;
  Failure failure;
  const double before = seconds_now();
  PetscCall(stepper->rebuild(elapsed, &failure));
  stepping += seconds_now() - before;
  if (const std::string news = stepper->drain_log(); !news.empty())
    PetscCall(log.print("step %ld: %s", step, news.c_str()));
  if (!failure.what.empty()) PetscCall(fail(failure.what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::write_row() {
  PetscFunctionBeginUser;
  HistoryRow row;
  row.step = step;
  row.time = schedule.time_of(step);
  row.dt = step > 0 ? schedule.step_size(step - 1) : dt;
  row.wall_time = wall();
  PetscCall(stepper->measure(row.time - last_row_time, &row));
  if (!config.probes.empty()) PetscCall(stepper->measure_probes(probes, &row.probes));
  last_row_time = row.time;
  row.stage = config.stage.number;
  if (config.balance) PetscCall(stepper->unbalanced_ratio(row.time, &row.unbalanced_ratio));
  last_unbalanced = row.unbalanced_ratio;
  for (std::size_t k = 0; k < rigid_zero.size(); ++k) row.rigids[k / 3].displacement[k % 3] -= rigid_zero[k];
  last_energy = row.energy;
  look_for_end(row);
  PetscCall(watch(row));
  PetscCall(agree(comm, rank_of(comm) == 0 ? history.write(row) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Reports notices once, and whether energy comes from nothing.
PetscErrorCode Simulation::Body::watch(const HistoryRow& row) {
  PetscFunctionBeginUser;
  for (const std::string& line : notices.report(row, config, rigid_zero)) PetscCall(log.line(line));
  if (!watching) {
    double wave_energy = 0;
    for (std::size_t b = 0; b < row.bodies.size(); ++b) {
      const double c = wave_speed(config, config.bodies[b]);
      wave_energy += row.bodies[b].mass * c * c / 2;
    }
    energy.begin(row, wave_energy);
    watching = true;
  } else if (const std::string fault = energy.check(row, config); !fault.empty()) {
    PetscCall(fail(fault));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::write_frame() {
  PetscFunctionBeginUser;
  if (config.output.partition) PetscCall(write_partition());
  if (!config.output.frames) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(frames.wait());  // the memory for one frame is enough
  Snapshot snapshot;
  snapshot.stage = config.stage.name;
  snapshot.step = step;
  snapshot.time = schedule.time_of(step);
  PetscCall(stepper->snapshot(&snapshot));
  PetscCall(frames.write(std::move(snapshot)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The row, the frame and the look for rasters at the end that a longer run would not have: a checkpoint
/// comes before them.
PetscErrorCode Simulation::Body::write_last_output() {
  PetscFunctionBeginUser;
  if (step == 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (!schedule.row_in_turn(step)) PetscCall(write_row());
  if (!schedule.raster_in_turn(step)) PetscCall(update_rasters());
  if (!schedule.frame_in_turn(step)) PetscCall(write_frame());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Which rank owns what, as rows of partition.csv.
PetscErrorCode Simulation::Body::write_partition() {
  PetscFunctionBeginUser;
  std::vector<OwnedPatch> patches;
  PetscCall(stepper->ownership(&patches));
  for (const OwnedPatch& p : patches)
    partition_rows += formatted("%ld,%.9g,%d,%d,%d,%d,%d\n", step, schedule.time_of(step), p.place[0],
                                p.place[1], p.place[2], p.particles, p.rank);
  const std::string path = config.output.directory + "/partition.csv";
  const std::string head = "step,time,patch_x,patch_y,patch_z,particles,rank\n";
  PetscCall(agree(comm, rank_of(comm) == 0 ? replace_file(path, head + partition_rows) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Performance of this part of the run, or of its stage. Where it did no step the stepper may not be set up,
/// and is not asked. Collective.
Performance Simulation::Body::performance() const {
  Performance p{.stepping = stepping - part.stepping,
                .steps = step - part.step,
                .particles = stepper->particles(),
                .looks = looks,
                .rebuilds = rebuilds,
                .shortest = shortest,
                .longest = longest,
                .interval = rebuilds > 0 ? double(step - since_rebuild) / rebuilds : 0,
                .strategy = stepper->strategy(),
                .device = device_name(config.backend),
                .bandwidth = bandwidth,
                .version = k_version,
                .outcome = word_of(outcome),
                .backend = word_of(config.backend),
                .precision = word_of(config.precision),
                .processor = processor_name(),
                .dim = config.dim,
                .ranks = ranks(),
                .threads = thread_count(config.backend),
                .cores = usable_cores(),
                .first_step = part.step,
                .time = schedule.time_of(step)};
  if (p.steps == 0) return p;
  p.functions = stepper->times();
  p.wall = wall() - part.wall;
  p.memory = double(stepper->memory());
  p.between_ranks = stepper->rank_figures();
  return p;
}

/// The report at the end of the log, and performance.json, which scripts read. The file is written even where
/// no step was done: its outcome then says that the run has ended.
PetscErrorCode Simulation::Body::report_performance() {
  PetscFunctionBeginUser;
  const Performance p = performance();
  if (p.steps > 0) {
    PetscCall(log.line(format_performance(p)));
    if (p.between_ranks) PetscCall(log.line(format_ranks(*p.between_ranks)));
    if (const std::string batches = stepper->batches_report(); !batches.empty()) PetscCall(log.line(batches));
  }
  PetscCall(
      agree(comm, rank_of(comm) == 0 ? write_performance_json(config.output.directory, p) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::finish() {
  PetscFunctionBeginUser;
  PetscCall(frames.settle());
  PetscCall(write_rasters());
  PetscCall(agree(comm, history.close()));
  if (outcome == Outcome::finished) PetscCall(agree(comm, forget_later()));
  if (config.output.energy) PetscCall(log.line(format_energy(last_energy)));
  PetscCall(report_performance());
  PetscCall(log.print("%s after %ld steps at time %g s; results are in %s", word_of(outcome), step,
                      schedule.time_of(step), config.output.directory.c_str()));
  PetscCall(agree(comm, log.close()));
  lock.release();
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
