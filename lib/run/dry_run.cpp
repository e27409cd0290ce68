// Cost of a run, from its model in numbers and a short trial.

#include "run/dry_run.hpp"

#include <algorithm>
#include <cmath>

#include "check/memory_need.hpp"
#include "output/frame_fields.hpp"
#include "output/probes.hpp"
#include "output/rasters.hpp"
#include "run/load_model.hpp"
#include "run/setup.hpp"
#include "run/stage_bodies.hpp"
#include "run/stages.hpp"

namespace mpm {
namespace {

/// Bytes of a frame, of which each rank has a part of the bodies, and rank 0 all of the rest.
double frame_bytes(const Snapshot& snapshot, const Config& config, bool first) {
  const double real = config.precision == Precision::single ? 4 : 8;
  double bytes = 0;
  for (const auto* groups : {&snapshot.bodies, &snapshot.rigids, &snapshot.nodes, &snapshot.contacts})
    for (const ParticleSnapshot& group : *groups) {
      if (!first && groups != &snapshot.bodies) continue;
      for (const Field& field : frame_fields())
        if (const auto* values = values_of(group, field))
          bytes += (is_exact(field) ? 8.0 : real) * values->size();
    }
  return bytes;
}

double checkpoint_bytes(const SavedState& state) {
  const auto of_points = [](const SavedPoints& points) {
    double bytes = 8.0 * points.address.size();
    for (const SavedField& field : points.fields) bytes += double(field.bytes) * field.values.size();
    return bytes;
  };
  return of_points(state.soil) + 8.0 * (state.impulse.address.size() + state.impulse.values.size());
}

/// Wall time of a step [s], from as many as a short trial allows; 0 where no step could be made.
PetscErrorCode time_steps(Job& job, Clock& clock, Stepper& stepper, double* seconds) {
  PetscFunctionBeginUser;
  constexpr double k_enough = 1;  // s
  constexpr long k_most = 500, k_first = 2;
  long done = 0;
  double took = 0;  // of all ranks, so that they end alike
  for (long steps = k_first; done < std::min(k_most, clock.schedule.last_whole_step()); steps *= 2) {
    Batch batch;
    PetscCall(stepper.advance(clock.schedule.range(done, std::min(steps, k_most - done)), &batch));
    done += batch.steps;
    took = done == k_first ? 0 : took + batch.seconds;  // the very first load kernels
    if (!batch.failure.what.empty()) {
      clock.step = done;
      PetscCall(fail(job, clock, "in the trial: " + batch.failure.what));
      break;
    }
    Failure failure;
    if (batch.rebuild) PetscCall(stepper.rebuild(0, &failure));
    if (!failure.what.empty() || batch.steps == 0 || took > k_enough) break;
  }
  *seconds = done > k_first ? took / (done - k_first) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Prints particles, memory, steps and output of the run.
PetscErrorCode report_need(Job& job, const Clock& clock, Stepper& stepper) {
  PetscFunctionBeginUser;
  Log& log = job.log;
  const Config& config = job.config;
  const int ranks = job.ranks();
  constexpr double k_row = 20;  // bytes of a number in the history
  const long steps = clock.schedule.last_step();
  const double end = clock.schedule.time_of(steps);
  const double frames_written = config.output.frames ? std::floor(end / config.output.interval) + 1 : 0;
  const double rows = std::floor(end / config.output.history_interval) + 1;
  double columns =
      4 + config.bodies.size() * (2.0 + 5 * config.dim) + config.rigids.size() * 3.0 * config.dim;
  for (const ProbeConfig& probe : config.probes) columns += double(columns_of(probe, config).size());
  Snapshot snapshot;
  SavedState state;
  PetscCall(stepper.snapshot(&snapshot));
  PetscCall(stepper.save(&state));
  double bytes[2] = {frame_bytes(snapshot, config, job.is_first()), checkpoint_bytes(state)};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bytes, 2, MPI_DOUBLE, MPI_SUM, job.comm));
  const auto [frame, checkpoint] = bytes;
  PetscCall(log.print("particles     %ld in %d patches, on %d rank%s", stepper.particles(), stepper.patches(),
                      ranks, ranks == 1 ? "" : "s"));
  PetscCall(log.print("memory        %.4g MB on the device, about %.4g MB beside on the host, a rank",
                      static_cast<double>(stepper.memory()) / ranks / 1e6,
                      memory_need(config).host / ranks / 1e6));
  PetscCall(log.print("time step     %.9g s, Courant number %.4f", clock.dt,
                      clock.dt / critical_time_step(config)));
  PetscCall(log.print("steps         %ld to %g s", steps, end));
  PetscCall(log.print(
      "output        %.0f frames of %.4g MB%s, %.0f rows of about %.0f bytes: %.4g MB; two checkpoints "
      "of %.4g MB",
      frames_written, frame / 1e6, config.output.compression > 0 ? " before compression" : "", rows,
      k_row * columns, (frames_written * frame + rows * k_row * columns) / 1e6, checkpoint / 1e6));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Where rigid bodies touch the soil.
PetscErrorCode report_contact(const Config& config, Log& log) {
  PetscFunctionBeginUser;
  std::string at[2];  // nodes, sites
  for (const RigidConfig& rigid : config.rigids) {
    std::string& names = at[rigid.contact_at_sites ? 1 : 0];
    names += (names.empty() ? "" : ", ") + rigid.name;
  }
  for (int sites = 0; sites < 2; ++sites)
    if (!at[sites].empty())
      PetscCall(log.print("contact       at %s: %s", sites ? "sites" : "nodes", at[sites].c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode report_rasters(const Config& config, Log& log) {
  PetscFunctionBeginUser;
  if (!config.rasters.on) PetscFunctionReturn(PETSC_SUCCESS);
  const ColumnGrid grid = column_grid(config);
  const RasterBytes raster = raster_bytes(config);
  PetscCall(
      log.print("rasters       %d x %d cells: %.4g MB on the device while they are made, %.4g MB on the "
                "host, a rank",
                grid.cells[0], grid.cells[1], raster.device / 1e6, raster.host / 1e6));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Makes the trial, and prints the wall time of the run by it. `step_seconds` [s]: of a step.
PetscErrorCode report_wall_time(Job& job, Clock& clock, Stepper& stepper, double* step_seconds) {
  PetscFunctionBeginUser;
  double seconds = 0;
  PetscCall(time_steps(job, clock, stepper, &seconds));
  if (const std::string batches = stepper.batches_report(); !batches.empty())
    PetscCall(job.log.line(batches));
  if (!job.goes_well() || seconds == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(job.log.print("wall time     about %s: %.4g us a step with strategy %s, without output",
                          format_duration(seconds * clock.schedule.last_step()).c_str(), 1e6 * seconds,
                          stepper.strategy().c_str()));
  *step_seconds = seconds;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Prints the cost of each stage, if the stage takes all of its time and the soil is as stiff as at its
/// start. The trial is of the first stage; the time of a step grows with the particles. device [bytes]: of
/// the first stage, measured, of a rank; step_seconds [s]: of its steps.
PetscErrorCode report_stages(Job& job, TimeStep& time_step, Clock& clock, double device,
                             double step_seconds) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const Schedule& schedule = clock.schedule;
  const MemoryNeed first = memory_need(config);
  double most = 0, seconds = 0;
  long steps = 0;
  for (std::size_t k = 0; k < job.report.stages.size(); ++k) {
    clock.stage.index = static_cast<long>(k);
    take_stage(job, clock);
    PetscCall(time_step.choose(job, clock));
    const MemoryNeed need = memory_need(config);
    const double memory = device * need.device / first.device;
    const long last = schedule.last_step(), own = last - clock.stage.step;
    PetscCall(
        job.log.print("stage %-7s to %g s%s: %ld steps of %.4g s; %.0f particles of soil, %.0f of rigid "
                      "bodies, about %.4g MB on the device, a rank",
                      config.stage.name.c_str(), schedule.time_of(last),
                      config.stage.end == StageEnd::time ? "" : " at most", own, clock.dt, need.particles,
                      need.rigids, memory / 1e6));
    most = std::max(most, memory), steps += own;
    seconds += own * step_seconds * std::max(need.particles, 1.0) / std::max(first.particles, 1.0);
    clock.stage.step = last, clock.stage.time = schedule.time_of(last);
  }
  PetscCall(
      job.log.print("all stages    %ld steps to %g s%s; about %.4g MB on the device at the most, a rank%s",
                    steps, clock.stage.time, time_step.follows() ? ", if the soil becomes no stiffer" : "",
                    most / 1e6, seconds > 0 ? (", and about " + format_duration(seconds)).c_str() : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode dry_run(Job& job, TimeStep& time_step, Clock& clock) {
  PetscFunctionBeginUser;
  const auto stepper = make_stepper(job.config, job.comm);
  PetscCall(begin_log(job));
  Model model;
  Failure failure;
  double step_seconds = 0;  // s of wall time of a step in the trial
  PetscCall(load_model(job, &model));
  PetscCall(leave_out(job, clock, nullptr, &model));
  PetscCall(stepper->set_up(std::move(model), &failure));
  if (!failure.what.empty()) {
    PetscCall(fail(job, clock, failure.what));
  } else {
    PetscCall(report_need(job, clock, *stepper));
    PetscCall(report_contact(job.config, job.log));
    PetscCall(report_rasters(job.config, job.log));
    PetscCall(report_wall_time(job, clock, *stepper, &step_seconds));
  }
  const double device = static_cast<double>(stepper->memory()) / job.ranks();
  if (job.goes_well() && job.report.stages.size() > 1)
    PetscCall(report_stages(job, time_step, clock, device, step_seconds));
  PetscCall(job.log.line("a dry run: nothing was written"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
