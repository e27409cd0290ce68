// -dry_run: what a run would take, from its model in numbers and a short trial. Writes nothing.

#include <algorithm>
#include <cmath>

#include "common/collectives.hpp"
#include "memory_need.hpp"
#include "output/frame_fields.hpp"
#include "simulation_body.hpp"

namespace mpm {
namespace {

/// Bytes of a frame, of which each rank has a part of the bodies, and rank 0 all of the rest.
double frame_bytes(const Snapshot& snapshot, const Config& config, bool first) {
  const double real = config.precision == Precision::single ? 4 : 8;
  double bytes = 0;
  for (const auto* groups : {&snapshot.bodies, &snapshot.rigids, &snapshot.nodes})
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

}  // namespace

/// Wall time of a step [s], from as many as a short trial allows; 0 where no step could be made.
PetscErrorCode Simulation::Body::time_steps(double* seconds) {
  PetscFunctionBeginUser;
  constexpr double k_enough = 1;  // s
  constexpr long k_most = 500, k_first = 2;
  long done = 0;
  double took = 0;  // of all ranks, so that they end alike
  for (long steps = k_first; done < std::min(k_most, schedule.last_whole_step()); steps *= 2) {
    Batch batch;
    PetscCall(stepper->advance(schedule.range(done, std::min(steps, k_most - done)), &batch));
    done += batch.steps;
    took = done == k_first ? 0 : took + batch.seconds;  // the very first load kernels
    if (!batch.failure.what.empty()) {
      step = done;
      PetscCall(fail("in the trial: " + batch.failure.what));
      break;
    }
    Failure failure;
    if (batch.rebuild) PetscCall(stepper->rebuild(0, &failure));
    if (!failure.what.empty() || batch.steps == 0 || took > k_enough) break;
  }
  *seconds = done > k_first ? took / (done - k_first) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::dry_run() {
  PetscFunctionBeginUser;
  PetscCall(begin());
  Model model;
  Failure failure;
  PetscCall(load(&model));
  PetscCall(leave_out(nullptr, &model));
  PetscCall(stepper->set_up(std::move(model), &failure));
  if (!failure.what.empty()) PetscCall(fail(failure.what));
  if (outcome == Outcome::finished) PetscCall(tell_need());
  if (outcome == Outcome::finished && report.stages.size() > 1) PetscCall(tell_stages());
  PetscCall(log.line("a dry run: nothing was written"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::tell_need() {
  PetscFunctionBeginUser;
  constexpr double k_row = 20;  // bytes of a number in the history
  const double end = schedule.time_of(schedule.last_step());
  const double frames_written = config.output.frames ? std::floor(end / config.output.interval) + 1 : 0;
  const double rows = std::floor(end / config.output.history_interval) + 1;
  double columns =
      4 + config.bodies.size() * (2.0 + 5 * config.dim) + config.rigids.size() * 3.0 * config.dim;
  for (const ProbeConfig& probe : config.probes) columns += double(columns_of(probe, config).size());
  const MemoryNeed need = memory_need(config);
  Snapshot snapshot;
  SavedState state;
  PetscCall(stepper->snapshot(&snapshot));
  PetscCall(stepper->save(&state));
  double bytes[2] = {frame_bytes(snapshot, config, rank_of(comm) == 0), checkpoint_bytes(state)};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bytes, 2, MPI_DOUBLE, MPI_SUM, comm));
  const auto [frame, checkpoint] = bytes;
  PetscCall(log.print("particles     %ld in %d patches, on %d rank%s", stepper->particles(),
                      stepper->patches(), ranks(), ranks() == 1 ? "" : "s"));
  PetscCall(log.print("memory        %.4g MB on the device, about %.4g MB beside on the host, a rank",
                      static_cast<double>(stepper->memory()) / ranks() / 1e6, need.host / ranks() / 1e6));
  PetscCall(log.print("time step     %.9g s, Courant number %.4f", dt, dt / critical_time_step(config)));
  PetscCall(log.print("steps         %ld to %g s", schedule.last_step(), end));
  PetscCall(log.print(
      "output        %.0f frames of %.4g MB%s, %.0f rows of about %.0f bytes: %.4g MB; two checkpoints "
      "of %.4g MB",
      frames_written, frame / 1e6, config.output.compression > 0 ? " before compression" : "", rows,
      k_row * columns, (frames_written * frame + rows * k_row * columns) / 1e6, checkpoint / 1e6));
  if (config.rasters.on) {
    const ColumnGrid grid = column_grid(config);
    const RasterBytes raster = raster_bytes(config);
    PetscCall(
        log.print("rasters       %d x %d cells: %.4g MB on the device while they are made, %.4g MB on the "
                  "host, a rank",
                  grid.cells[0], grid.cells[1], raster.device / 1e6, raster.host / 1e6));
  }
  double seconds = 0;
  PetscCall(time_steps(&seconds));
  if (const std::string batches = stepper->batches_report(); !batches.empty()) PetscCall(log.line(batches));
  if (outcome != Outcome::finished || seconds == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(log.print("wall time     about %s: %.4g us a step with strategy %s, without output",
                      format_duration(seconds * schedule.last_step()).c_str(), 1e6 * seconds,
                      stepper->strategy().c_str()));
  step_seconds = seconds;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Prints the cost of each stage, if the stage takes all of its time and the soil is as stiff as at its
/// start. The trial is of the first stage; the time of a step grows with the particles.
PetscErrorCode Simulation::Body::tell_stages() {
  PetscFunctionBeginUser;
  const double device = static_cast<double>(stepper->memory()) / ranks();  // of the first, measured
  const MemoryNeed first = memory_need(config);
  double most = 0, seconds = 0;
  long steps = 0;
  for (int k = 0; k < static_cast<int>(report.stages.size()); ++k) {
    take_stage(k);
    PetscCall(choose_time_step());
    const MemoryNeed need = memory_need(config);
    const double memory = device * need.device / first.device;
    const long own = schedule.last_step() - stage_begin.step;
    PetscCall(
        log.print("stage %-7s to %g s%s: %ld steps of %.4g s; %.0f particles of soil, %.0f of rigid "
                  "bodies, about %.4g MB on the device, a rank",
                  config.stage.name.c_str(), schedule.time_of(schedule.last_step()),
                  config.stage.end == StageEnd::time ? "" : " at most", own, dt, need.particles, need.rigids,
                  memory / 1e6));
    most = std::max(most, memory), steps += own;
    seconds += own * step_seconds * std::max(need.particles, 1.0) / std::max(first.particles, 1.0);
    stage_begin = {schedule.last_step(), schedule.time_of(schedule.last_step())};
  }
  PetscCall(log.print("all stages    %ld steps to %g s%s; about %.4g MB on the device at the most, a rank%s",
                      steps, stage_begin.time, follows ? ", if the soil becomes no stiffer" : "", most / 1e6,
                      seconds > 0 ? (", and about " + format_duration(seconds)).c_str() : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
