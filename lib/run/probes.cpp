#include "run/probes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/text.hpp"

namespace mpm {

PetscErrorCode Probes::begin(Job& job, const Clock& clock, Stepper& stepper) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  if (!config.probes.empty()) PetscCall(stepper.begin_probes(&state_));
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    if (config.probes[n].kind != ProbeKind::particle || state_.followed[n] < 0) continue;
    Vec3 at{};
    for (int d = 0; d < config.dim; ++d) at[d] = state_.start[3 * n + d] + config.mesh.lower[d];
    PetscCall(job.log.print("probe %s follows the particle at %s", config.probes[n].name.c_str(),
                            text_of(at, config.dim).c_str()));
  }
  if (config.rasters.on) PetscCallCXX(rasters_.begin(config));
  PetscCall(update_rasters(config, clock.time(), stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Probes::measure(const Config& config, Stepper& stepper, std::vector<double>* values) const {
  PetscFunctionBeginUser;
  if (!config.probes.empty()) PetscCall(stepper.measure_probes(state_, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Probes::update_rasters(const Config& config, double time, Stepper& stepper) {
  PetscFunctionBeginUser;
  if (!config.rasters.on) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<long> sums;
  PetscCall(stepper.sum_columns(&sums));
  rasters_.update(config, time, sums);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Probes::write_rasters(const Job& job, Stepper& stepper) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  if (rasters_.most_depth.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  if (job.outcome != Outcome::failed) {
    std::vector<long> sums;
    PetscCall(stepper.sum_columns(&sums));
    rasters_.look(config, sums);
  }
  PetscCall(
      agree(job.comm, job.is_first() ? rasters_.write(config, config.output.directory) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::string probes_fault(const Checkpoint& checkpoint, const Config& config) {
  const ProbeState& state = checkpoint.probes;
  const std::size_t count = config.probes.size();
  bool sound = state.followed.size() == count && state.start.size() == 3 * count &&
               state.section_zero.size() == 2 * count;
  for (const long id : state.followed) sound = sound && id >= -1 && id < std::numeric_limits<int>::max();
  for (const auto* values : {&state.start, &state.section_zero})
    for (const double value : *values) sound = sound && std::isfinite(value);
  if (!sound) return "a checkpoint with sound followed, followed_start and section_zero";
  if (!are_sound(checkpoint.rasters, config))
    return "a checkpoint with a sound raster_depth, raster_speed and raster_arrival";
  return "";
}

PetscErrorCode Probes::reset(const Config& config, Stepper& stepper) {
  PetscFunctionBeginUser;
  if (config.probes.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<double> values;
  PetscCall(stepper.measure_probes(state_, &values));
  std::size_t column = 0;
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    if (config.probes[n].kind == ProbeKind::particle && std::isfinite(values[column]))
      for (int d = 0; d < config.dim; ++d)
        state_.start[3 * n + d] = values[column + d] - config.mesh.lower[d];
    column += columns_of(config.probes[n], config).size();
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Probes::follow_placed(const Config& config, Stepper& stepper) {
  PetscFunctionBeginUser;
  if (config.probes.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  ProbeState now;
  PetscCall(stepper.begin_probes(&now));
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    if (state_.followed[n] >= 0 || now.followed[n] < 0) continue;
    state_.followed[n] = now.followed[n];
    std::copy_n(&now.start[3 * n], 3, &state_.start[3 * n]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Probes::keep_sections(const Config& config, const std::vector<SectionSum>& before,
                                     Stepper& stepper) {
  PetscFunctionBeginUser;
  std::vector<SectionSum> after;
  PetscCall(stepper.sum_sections(&after));
  for (std::size_t n = 0, section = 0; n < config.probes.size(); ++n) {
    if (config.probes[n].kind != ProbeKind::section) continue;
    state_.section_zero[2 * n] += after[section].mass - before[section].mass;
    state_.section_zero[2 * n + 1] += after[section].initial_volume - before[section].initial_volume;
    ++section;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
