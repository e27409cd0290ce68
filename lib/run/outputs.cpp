#include "run/outputs.hpp"

#include <utility>

#include "checkpoint/folder.hpp"
#include "common/text.hpp"
#include "output/files.hpp"

namespace mpm {

PetscErrorCode Outputs::open(Job& job, const Config& columns) {
  PetscFunctionBeginUser;
  const OutputConfig& output = job.config.output;
  PetscCall(agree(job.comm, job.is_first() ? history_.open(columns) : PETSC_SUCCESS));
  frames_.open(output.directory, job.config.precision, {output.fields, output.compression}, job.comm);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Outputs::go_on(Job& job, const Config& columns, const std::string& rows, long frames) {
  PetscFunctionBeginUser;
  int removed = 0;
  const bool first = job.is_first();
  const std::string& folder = job.config.output.directory;
  PetscCall(agree(job.comm, first ? remove_unfinished(folder, &removed) : PETSC_SUCCESS));
  if (removed > 0) PetscCall(job.log.print("%d files that were not finished were removed", removed));
  if (rows.empty()) PetscCall(job.log.line("there is no history.csv to go on with: a new one begins here"));
  PetscCall(agree(job.comm, first ? history_.open(columns, rows) : PETSC_SUCCESS));
  PetscCall(frames_.resume(job.config, frames, job.comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Outputs::settle(const Job& job, Checkpoint* checkpoint) {
  PetscFunctionBeginUser;
  HistoryMark& history = checkpoint->history;
  PetscCall(frames_.settle());
  PetscCall(agree(job.comm, job.is_first() ? history_.settle(&history) : PETSC_SUCCESS));
  double mark[2] = {double(history.bytes), double(history.crc)};
  PetscCall(share_numbers(job.comm, 2, mark));
  history = {static_cast<long>(mark[0]), static_cast<std::uint32_t>(mark[1])};
  checkpoint->frames = frames();
  checkpoint->run.last_row_time = last_row_.time;
  probes_.save(*checkpoint);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Outputs::close(Job& job, Stepper& stepper) {
  PetscFunctionBeginUser;
  PetscCall(frames_.settle());
  PetscCall(probes_.write_rasters(job, stepper));
  PetscCall(agree(job.comm, history_.close()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Outputs::write_row(Job& job, const Clock& clock, double wall, Stepper& stepper) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const double before = last_row_.time;
  last_row_ = {};
  HistoryRow& row = last_row_;
  row.step = clock.step;
  row.time = clock.time();
  row.dt = clock.step > 0 ? clock.schedule.step_size(clock.step - 1) : clock.dt;
  row.wall_time = wall;
  PetscCall(stepper.measure(row.time - before, &row));
  PetscCall(probes_.measure(config, stepper, &row.probes));
  row.stage = config.stage.number;
  if (config.balance) PetscCall(stepper.unbalanced_ratio(row.time, &row.unbalanced_ratio));
  const std::vector<double>& zero = clock.stage.rigid_zero;
  for (std::size_t k = 0; k < zero.size(); ++k) row.rigids[k / 3].displacement[k % 3] -= zero[k];
  PetscCall(watch(job, clock));
  PetscCall(agree(job.comm, job.is_first() ? history_.write(row) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Reports notices once, and whether energy comes from nothing.
PetscErrorCode Outputs::watch(Job& job, const Clock& clock) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  for (const std::string& line : notices_.report(last_row_, config, clock.stage.rigid_zero))
    PetscCall(job.log.line(line));
  if (!watching_) {
    double wave_energy = 0;
    for (std::size_t b = 0; b < last_row_.bodies.size(); ++b) {
      const double c = wave_speed(config, config.bodies[b]);
      wave_energy += last_row_.bodies[b].mass * c * c / 2;
    }
    energy_.begin(last_row_, wave_energy);
    watching_ = true;
  } else if (const std::string fault = energy_.check(last_row_, config); !fault.empty()) {
    PetscCall(fail(job, clock, fault));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Outputs::write_frame(const Job& job, const Clock& clock, Stepper& stepper) {
  PetscFunctionBeginUser;
  if (job.config.output.partition) PetscCall(write_partition(job, clock, stepper));
  if (!job.config.output.frames) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(frames_.wait());  // the memory for one frame is enough
  Snapshot snapshot;
  snapshot.stage = job.config.stage.name;
  snapshot.step = clock.step;
  snapshot.time = clock.time();
  PetscCall(stepper.snapshot(&snapshot));
  PetscCall(frames_.write(std::move(snapshot)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Outputs::write_fields(const Job& job, const Clock& clock, bool in_turn, Stepper& stepper) {
  PetscFunctionBeginUser;
  if (clock.schedule.raster_in_turn(clock.step) == in_turn)
    PetscCall(probes_.update_rasters(job.config, clock.time(), stepper));
  if (clock.schedule.frame_in_turn(clock.step) == in_turn) PetscCall(write_frame(job, clock, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Which rank owns what, as rows of partition.csv.
PetscErrorCode Outputs::write_partition(const Job& job, const Clock& clock, Stepper& stepper) {
  PetscFunctionBeginUser;
  std::vector<OwnedPatch> patches;
  PetscCall(stepper.ownership(&patches));
  for (const OwnedPatch& p : patches)
    partition_rows_ += formatted("%ld,%.9g,%d,%d,%d,%d,%d\n", clock.step, clock.time(), p.place[0],
                                 p.place[1], p.place[2], p.particles, p.rank);
  const std::string path = job.config.output.directory + "/partition.csv";
  const std::string head = "step,time,patch_x,patch_y,patch_z,particles,rank\n";
  PetscCall(agree(job.comm, job.is_first() ? replace_file(path, head + partition_rows_) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
