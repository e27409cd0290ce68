#include "run/stage_bodies.hpp"

#include <algorithm>
#include <limits>

#include "checkpoint/id_blocks.hpp"
#include "common/text.hpp"
#include "input/files/checkpoint_particles.hpp"
#include "input/geometry/load_faces.hpp"
#include "input/geometry/shapes.hpp"
#include "step/stage_loads.hpp"
#include "step/state_map.hpp"

namespace mpm {
namespace {

/// The numbers of a field for each point; empty where there is none of the name.
std::vector<double> numbers_of(const SavedPoints& points, const char* name) {
  for (const SavedField& field : points.fields)
    if (field.name == name) return field.values;
  return {};
}

bool has(const std::vector<int>& list, int index) {
  return std::find(list.begin(), list.end(), index) != list.end();
}

/// Removes the marked particles from the state: they count as lost. `mass` [kg]: of each body, what this
/// removed; of all ranks.
PetscErrorCode remove_particles(MPI_Comm comm, int dim, const std::vector<char>& out, SavedState& state,
                                std::vector<double>* mass_gone) {
  PetscFunctionBeginUser;
  const auto body = numbers_of(state.soil, "body"), mass = numbers_of(state.soil, "mass"),
             velocity = numbers_of(state.soil, "velocity");
  std::vector<double> gone(state.lost.size());
  for (std::size_t p = 0; p < state.soil.id.size(); ++p) {
    if (out[p] == 0) continue;
    double* const lost = &gone[static_cast<std::size_t>(body[p]) * k_lost];  // count, mass, energy, momentum
    lost[0] += 1, lost[1] += mass[p];
    for (int d = 0; d < dim; ++d) {
      const double v = velocity[p * dim + d];
      lost[2] += mass[p] * v * v / 2, lost[3 + d] += mass[p] * v;
    }
    state.soil.address[p] = -1;
  }
  leave_out_lost(state.soil);
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, gone.data(), static_cast<int>(gone.size()), MPI_DOUBLE, MPI_SUM, comm));
  for (std::size_t k = 0; k < gone.size(); ++k) state.lost[k] += gone[k];
  for (std::size_t k = 1; k < gone.size(); k += k_lost) mass_gone->push_back(gone[k]);
  state.alone_known = 0, state.alone.clear();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Bounds of all that a stage places [m], and a margin.
Bounds bounds_of_placed(const Config& config) {
  constexpr double k_far = std::numeric_limits<double>::max(), k_margin = 2;  // cells
  Bounds all;
  for (int d = 0; d < config.dim; ++d) all.lower[d] = k_far, all.upper[d] = -k_far;
  const auto add = [&](const Bounds& bounds) {
    for (int d = 0; d < config.dim; ++d) {
      all.lower[d] = std::min(all.lower[d], bounds.lower[d] - k_margin * config.mesh.spacing);
      all.upper[d] = std::max(all.upper[d], bounds.upper[d] + k_margin * config.mesh.spacing);
    }
  };
  for (const int b : config.stage.place) {
    const Shape& shape = config.bodies[b].shape;
    add(shape.kind == ShapeKind::particles ? Bounds{config.mesh.lower, config.mesh.upper}
                                           : bounds_of(shape, config.mesh, config.dim));
  }
  for (const int r : config.stage.place_rigids)
    add(bounds_of(config.rigids[r].shape, config.mesh, config.dim));
  return all;
}

/// The names that two lists of state variables have in common, as the end of "its stress stays".
std::string kept_text(const std::string& before, const std::string& now) {
  const auto had = split(before);
  std::vector<std::string> kept;
  for (const std::string& name : split(now))
    if (!name.empty() && std::find(had.begin(), had.end(), name) != had.end()) kept.push_back(name);
  return kept.empty() ? "" : ", and of its state " + join(kept, ", ");
}

/// Collects the soil and rigids that are near the bodies of a stage when the stage begins.
PetscErrorCode look_at_present(const Job& job, const SavedState& state, Present* present) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const int dim = config.dim;
  present->soil.assign(config.bodies.size(), {});
  for (const SavedRigid& rigid : state.rigids)
    present->rigids.push_back(vector_of(rigid, MotionTerms::displacement));
  const Bounds bounds = bounds_of_placed(config);
  const auto position = positions_of(state.soil, config.mesh, dim);
  const auto body = numbers_of(state.soil, "body");
  std::vector<double> all;  // rows of body and position
  for (std::size_t p = 0; p < body.size(); ++p) {
    const double* const x = &position[p * dim];
    bool near = true;
    for (int d = 0; d < dim; ++d) near = near && x[d] >= bounds.lower[d] && x[d] <= bounds.upper[d];
    if (near) all.push_back(body[p]), all.insert(all.end(), x, x + dim);
  }
  PetscCall(share_records(job.comm, &all));
  for (std::size_t at = 0; at < all.size(); at += 1 + dim) {
    auto& of_body = present->soil[static_cast<std::size_t>(all[at])];
    of_body.insert(of_body.end(), &all[at + 1], &all[at + 1] + dim);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Removes the soil that is in the shapes of what the stage places, of bodies that are cut by these.
PetscErrorCode cut_present(Job& job, SavedState& state) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const int dim = config.dim;
  Present none{std::vector<std::vector<double>>(config.bodies.size()),
               std::vector<Vec3>(config.rigids.size())};
  const auto position = positions_of(state.soil, config.mesh, dim);
  const auto body = numbers_of(state.soil, "body");
  std::vector<char> out(body.size());
  for (int b = 0; b < static_cast<int>(config.bodies.size()); ++b) {
    std::vector<double> own;
    std::vector<std::size_t> rows;
    for (std::size_t p = 0; p < body.size(); ++p)
      if (body[p] == b) {
        rows.push_back(p);
        own.insert(own.end(), &position[p * dim], &position[p * dim] + dim);
      }
    const std::vector<char> cut = cut_at_stage(config, b, none, own);
    for (std::size_t n = 0; n < rows.size(); ++n) out[rows[n]] = cut[n];
  }
  int any = std::find(out.begin(), out.end(), 1) != out.end();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, job.comm));
  if (!any) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<double> mass;
  PetscCall(remove_particles(job.comm, dim, out, state, &mass));
  for (std::size_t b = 0; b < mass.size(); ++b)
    if (mass[b] > 0)
      PetscCall(job.log.print("body %s: %.9g kg are in the place of what is placed, and were cut out",
                              config.bodies[b].name.c_str(), mass[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

bool changes_soil(const StageConfig& stage) {
  return !stage.remove.empty() || !stage.place.empty() || !stage.place_rigids.empty();
}

PetscErrorCode change_bodies(Job& job, const Clock& clock, SavedState& state, Present* present) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const StageConfig& stage = config.stage;
  std::vector<char> out(state.soil.id.size());
  std::vector<double> mass;
  const auto of_body = numbers_of(state.soil, "body");
  for (std::size_t p = 0; p < out.size(); ++p) out[p] = has(stage.remove, static_cast<int>(of_body[p]));
  if (!stage.remove.empty()) PetscCall(remove_particles(job.comm, config.dim, out, state, &mass));
  for (const int r : stage.remove_rigids) {
    set_vector(state.rigids[r], MotionTerms::velocity, {});
    std::fill_n(&state.rigids[r][MotionTerms::impulse], MotionTerms::impulse_size, 0.0);
  }
  for (const int r : stage.place_rigids) {
    const RigidConfig& rigid = config.rigids[r];
    state.rigids[r] = {};
    if (rigid.motion != Motion::fixed) set_vector(state.rigids[r], MotionTerms::velocity, rigid.velocity);
    PetscCall(job.log.print("rigid %s is placed", rigid.name.c_str()));
  }
  if (stage.place.empty() && stage.place_rigids.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(cut_present(job, state));
  PetscCall(look_at_present(job, state, present));
  std::vector<Overlap> overlaps;
  PetscCall(find_overlaps_at_stage(job.comm, config, *present, &overlaps));
  if (!overlaps.empty()) PetscCall(fail(job, clock, describe_at_stage(overlaps, config)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode leave_out(Job& job, const Clock& clock, const Present* present, Model* model) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const bool places = present != nullptr && !config.stage.place.empty();
  for (int b = 0; b < static_cast<int>(config.bodies.size()); ++b) {
    BodyParticles& particles = model->bodies[b];
    const std::size_t count = particles.position.size() / config.dim;
    const bool placed = has(config.stage.place, b);
    if (config.bodies[b].absent || (places && !placed)) particles.left_out.assign(count, 1);
    if (!places || !placed) continue;
    std::vector<double> position = particles.position;
    for (std::size_t k = 0; k < position.size(); ++k) position[k] += config.mesh.lower[k % config.dim];
    particles.left_out = cut_at_stage(config, b, *present, position);
    long counts[2] = {static_cast<long>(count),
                      std::count(particles.left_out.begin(), particles.left_out.end(), 1)};
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_LONG, MPI_SUM, job.comm));
    PetscCall(job.log.print("body %s is placed: %ld particles%s", config.bodies[b].name.c_str(),
                            counts[0] - counts[1],
                            counts[1] > 0 ? formatted("; %ld were cut out", counts[1]).c_str() : ""));
    if (counts[0] == counts[1])
      PetscCall(fail(
          job, clock,
          formatted("stage %s places no particle of %s: -%s_cut_out leaves none", config.stage.name.c_str(),
                    config.bodies[b].name.c_str(), config.bodies[b].name.c_str())));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode adapt_state(Job& job, const Clock& clock, const Stepper& stepper, const NewBodies& bodies,
                           SavedState& state) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const std::vector<char>& changed = bodies.changed;
  if (bodies.placed.empty() && !bodies.any_changed()) PetscFunctionReturn(PETSC_SUCCESS);
  SavedState fresh;
  PetscCall(stepper.save(&fresh));
  PetscCall(bring_together(job.comm, &fresh));
  const std::vector<std::string> before = state.variables;
  std::string fault;
  PetscCallCXX(fault = map_state(config, changed, fresh, state));
  PetscCall(share_text(job.comm, &fault));
  for (std::size_t b = 0; b < changed.size(); ++b) {
    const BodyConfig& body = config.bodies[b];
    if (changed[b] == 0 || !(body.from_before || bodies.all_were_there)) continue;
    PetscCall(job.log.print("body %s has the material %s with the present parameters: its stress stays%s",
                            body.name.c_str(), config.materials[body.material].name.c_str(),
                            kept_text(before[b], fresh.variables[b]).c_str()));
  }
  if (!fault.empty()) PetscCall(fail(job, clock, fault));
  if (fault.empty()) PetscCallCXX(add_bodies(bodies.placed, fresh, state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_loads(Job& job, const Clock& clock, SavedState& state) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  std::vector<LoadedSurface> surfaces;
  std::string fault;
  PetscCall(find_stage_faces(job.comm, config, &state, &surfaces, &fault));
  const std::vector<int> loads = loads_from_stage(config, config.stage.number);
  for (std::size_t n = 0; n < loads.size(); ++n)
    PetscCall(job.log.line(describe_surface(config, loads[n], surfaces[n])));
  if (!fault.empty()) PetscCall(fail(job, clock, fault));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
