// Probes of the history, and rasters of what passed.

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/collectives.hpp"
#include "common/text.hpp"
#include "simulation_body.hpp"

namespace mpm {

/// At the start of a run: what probes follow, and the first look for the rasters.
PetscErrorCode Simulation::Body::begin_probes() {
  PetscFunctionBeginUser;
  if (!config.probes.empty()) PetscCall(stepper->begin_probes(&probes));
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    if (config.probes[n].kind != ProbeKind::particle || probes.followed[n] < 0) continue;
    Vec3 at{};
    for (int d = 0; d < config.dim; ++d) at[d] = probes.start[3 * n + d] + config.mesh.lower[d];
    PetscCall(log.print("probe %s follows the particle at %s", config.probes[n].name.c_str(),
                        text_of(at, config.dim).c_str()));
  }
  if (config.rasters.on) PetscCallCXX(rasters.begin(config));
  PetscCall(update_rasters());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::update_rasters() {
  PetscFunctionBeginUser;
  if (!config.rasters.on) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<long> sums;
  PetscCall(stepper->sum_columns(&sums));
  rasters.update(config, schedule.time_of(step), sums);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Writes the rasters so far, with the depth as it is now; in a run that failed, with the depth of the last
/// update.
PetscErrorCode Simulation::Body::write_rasters() {
  PetscFunctionBeginUser;
  if (rasters.most_depth.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  if (outcome != Outcome::failed) {
    std::vector<long> sums;
    PetscCall(stepper->sum_columns(&sums));
    rasters.look(config, sums);
  }
  const bool first = rank_of(comm) == 0;
  PetscCall(agree(comm, first ? rasters.write(config, config.output.directory) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Fault of the probes and rasters in the checkpoint of a restart, as the end of "takes ..."; empty if there
/// is none.
std::string Simulation::Body::probes_fault() const {
  const ProbeState& state = restart->probes;
  const std::size_t count = config.probes.size();
  bool sound = state.followed.size() == count && state.start.size() == 3 * count &&
               state.section_zero.size() == 2 * count;
  for (const long id : state.followed) sound = sound && id >= -1 && id < std::numeric_limits<int>::max();
  for (const auto* values : {&state.start, &state.section_zero})
    for (const double value : *values) sound = sound && std::isfinite(value);
  if (!sound) return "a checkpoint with sound followed, followed_start and section_zero";
  if (!are_sound(restart->rasters, config))
    return "a checkpoint with a sound raster_depth, raster_speed and raster_arrival";
  return "";
}

/// Displacements of particles that are followed begin anew.
PetscErrorCode Simulation::Body::reset_probes() {
  PetscFunctionBeginUser;
  if (config.probes.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<double> values;
  PetscCall(stepper->measure_probes(probes, &values));
  std::size_t column = 0;
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    if (config.probes[n].kind == ProbeKind::particle && std::isfinite(values[column]))
      for (int d = 0; d < config.dim; ++d)
        probes.start[3 * n + d] = values[column + d] - config.mesh.lower[d];
    column += columns_of(config.probes[n], config).size();
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Particles for the probes that follow one of a body that was not there before.
PetscErrorCode Simulation::Body::follow_placed() {
  PetscFunctionBeginUser;
  if (config.probes.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  ProbeState now;
  PetscCall(stepper->begin_probes(&now));
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    if (probes.followed[n] >= 0 || now.followed[n] < 0) continue;
    probes.followed[n] = now.followed[n];
    std::copy_n(&now.start[3 * n], 3, &probes.start[3 * n]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A stage that removes or places bodies takes nothing through a section: what is beyond counts from the new
/// start.
PetscErrorCode Simulation::Body::keep_sections(const std::vector<SectionSum>& before) {
  PetscFunctionBeginUser;
  std::vector<SectionSum> after;
  PetscCall(stepper->sum_sections(&after));
  for (std::size_t n = 0, section = 0; n < config.probes.size(); ++n) {
    if (config.probes[n].kind != ProbeKind::section) continue;
    probes.section_zero[2 * n] += after[section].mass - before[section].mass;
    probes.section_zero[2 * n + 1] += after[section].initial_volume - before[section].initial_volume;
    ++section;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
