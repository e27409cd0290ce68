#include "run/load_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/presence.hpp"
#include "common/revolution.hpp"
#include "common/text.hpp"
#include "input/files/field_file.hpp"
#include "input/geometry/load_faces.hpp"
#include "input/options/groups.hpp"
#include "input/options/level_ground.hpp"
#include "mesh/background.hpp"
#include "parallel/distribute.hpp"

namespace mpm {
namespace {

/// Masses of particles whose volumes differ.
void weigh(double density, BodyParticles& particles) {
  if (particles.most_volume == 0) return;
  for (const double volume : particles.volume) particles.mass.push_back(density * volume);
  particles.least_mass = density * particles.least_volume;
}

/// Volumes and masses of particles that are rings. The bounds of their volumes remain those of their
/// sections.
PetscErrorCode revolve(MPI_Comm comm, const Config& config, double density, BodyParticles* particles) {
  PetscFunctionBeginUser;
  if (config.geometry != Geometry::axisymmetric) PetscFunctionReturn(PETSC_SUCCESS);
  BodyParticles& all = *particles;
  if (all.most_volume == 0) all.least_volume = all.most_volume = all.particle_volume;
  all.volume.resize(all.position.size() / config.dim, all.particle_volume);
  double least = std::numeric_limits<double>::max();
  for (std::size_t p = 0; p < all.volume.size(); ++p) {
    all.volume[p] *= revolved_length(config, all.position[p * config.dim]);
    all.mass.push_back(density * all.volume[p]);
    least = std::min(least, all.mass[p]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, comm));
  all.least_mass = least;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Whether a rigid body is in the run since the present stage, or the run has none.
bool is_new(const Config& config, const RigidConfig& rigid) {
  return std::max(1, placed_at(config.stage, rigid.name)) >= config.stage.number;
}

/// Each particle's own strength and Young's modulus, from a field that was checked with the options.
PetscErrorCode take_field(Job& job, const BodyConfig& body, BodyParticles* particles) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  std::vector<NamedGrid> grids;
  std::string fault;
  PetscCallCXX(fault = read_body_grids(body, config, grids));
  PetscCheck(fault.empty(), job.comm, PETSC_ERR_FILE_READ, "%s has changed: it should be %s",
             body.field.c_str(), fault.c_str());
  for (const auto& [key, grid] : grids) {
    StateField& own = particles->own_parameters.emplace_back(StateField{key, {}});
    double ends[2] = {std::numeric_limits<double>::max(),
                      std::numeric_limits<double>::max()};  // least, -most
    for (std::size_t p = 0; p < particles->position.size(); p += config.dim) {
      Vec3 x{};
      std::copy_n(&particles->position[p], config.dim, x.begin());
      const double value = grid.at(x);
      PetscCallCXX(own.values.push_back(value));
      ends[0] = std::min(ends[0], value), ends[1] = std::min(ends[1], -value);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_DOUBLE, MPI_MIN, job.comm));
    if (body.from_before) continue;
    PetscCall(job.log.print("body %s: %s of each particle from %s, %.6g to %.6g", body.name.c_str(),
                            key.c_str(), body.field.c_str(), ends[0], -ends[1]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The stress of level ground, of each particle by its height.
PetscErrorCode take_level_ground(Job& job, const BodyConfig& body, Model* model, BodyParticles* particles) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const LevelGround ground(config);
  const int components = config.dim == 2 ? 4 : 6;
  for (std::size_t p = 0; p < particles->position.size(); p += config.dim) {
    Vec3 centre{};
    std::copy_n(&particles->position[p], config.dim, centre.begin());
    const Sym6 stress = ground.stress(body, centre, particles->spacing);
    PetscCallCXX(
        particles->stress.insert(particles->stress.end(), stress.begin(), stress.begin() + components));
  }
  model->from_run = true;  // a stress that F-bar would bring together in a cell is in equilibrium as it is
  if (body.from_before) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
      job.log.print("body %s: stress of level ground, %.6g Pa vertical at its lowest particles, K0 %.4g",
                    body.name.c_str(), body.stress[config.dim - 1], k0_of(config.materials[body.material])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Volumes of parts of cells: one figure for all where they are the same. The masses follow with the density
/// of the material.
PetscErrorCode take_volumes(MPI_Comm comm, std::vector<double>&& volume, BodyParticles* particles) {
  PetscFunctionBeginUser;
  double ends[2] = {particles->particle_volume, particles->particle_volume};  // least, most
  for (const double v : volume) ends[0] = std::min(ends[0], v), ends[1] = std::max(ends[1], v);
  ends[1] = -ends[1];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_DOUBLE, MPI_MIN, comm));
  if (ends[0] == -ends[1]) PetscFunctionReturn(PETSC_SUCCESS);
  particles->least_volume = ends[0], particles->most_volume = -ends[1];
  particles->volume = std::move(volume);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// in_parts: each rank has a part of the lattice.
PetscErrorCode log_shape(Job& job, const std::string& name, const Lattice& lattice, bool in_parts) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  long counts[2] = {static_cast<long>(lattice.position.size()) / config.dim, lattice.cut_out};
  double volumes[2] = {lattice.held_volume(), lattice.cut_volume};
  if (in_parts) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_LONG, MPI_SUM, job.comm));
  if (in_parts) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, volumes, 2, MPI_DOUBLE, MPI_SUM, job.comm));
  const auto [count, cut_out] = counts;
  const char* unit = config.dim == 3                             ? "m3"
                     : config.geometry == Geometry::axisymmetric ? "m2 of the section"
                                                                 : "m2";
  PetscCall(job.log.print("%s: %ld particles stand for %.6g %s, the shape has %.6g %s", name.c_str(), count,
                          volumes[0], unit, lattice.shape_volume, unit));
  if (cut_out > 0)
    PetscCall(
        job.log.print("%s: %ld particles, %.6g %s, were cut out", name.c_str(), cut_out, volumes[1], unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The planes of symmetry that cut a shape.
PetscErrorCode log_cuts(Job& job, const std::string& name, const Shape& shape) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const Cuts cuts = cuts_of(shape, config.mesh, config.dim);
  std::string sides;
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side)
      if (cuts[d][side]) sides += std::string(sides.empty() ? "-" : ", -") + side_option(d, side);
  if (!sides.empty())
    PetscCall(job.log.print(
        "%s: cut by the plane of symmetry at %s; masses and forces are those of the part inside",
        name.c_str(), sides.c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Particles of a shape's lattice, or this rank's part of them. Their positions are absolute, as in a file.
/// name: for the log; empty: the log has it already.
PetscErrorCode load_shape(Job& job, const std::string& name, const Shape& shape,
                          const std::vector<Shape>& cut_out, LatticePart part, BodyParticles* particles) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  Lattice lattice;
  PetscCall(fill(shape, config.mesh, config.dim, lattice, cut_out, part));
  if (!name.empty()) PetscCall(log_shape(job, name, lattice, part.of > 1));
  if (!name.empty()) PetscCall(log_cuts(job, name, shape));
  particles->position = std::move(lattice.position);
  particles->spacing = lattice.spacing;
  particles->particle_volume = lattice.particle_volume;
  PetscCall(take_volumes(job.comm, std::move(lattice.volume), particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode load_model(Job& job, Model* model) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  BackgroundMesh mesh;
  PetscCall(mesh.create(job.comm, config.mesh, config.dim));
  model->patches = mesh.patches_with_ring();
  if (config.geometry == Geometry::axisymmetric)
    PetscCall(job.log.print(
        "axisymmetric: x is the radius and y the axis; masses, forces and energies are those of the "
        "whole revolution"));
  for (const auto& body : config.bodies) {
    const bool listed = body.shape.kind == ShapeKind::particles;
    BodyParticles& particles = model->bodies.emplace_back();
    PetscCall(listed ? load_file(job, body, &particles, &model->from_run)
                     : load_shape(job, body.from_before ? "" : "body " + body.name, body.shape,
                                  cut_out_of(config, body), {rank_of(job.comm), job.ranks()}, &particles));
    const double density = density_of(config, body);
    if (!listed && config.geometry == Geometry::plane_strain) weigh(density, particles);
    if (!listed) PetscCall(revolve(job.comm, config, density, &particles));
    if (!body.field.empty() && takes_field(body, config)) PetscCall(take_field(job, body, &particles));
    if (body.k0 && !body.absent) PetscCall(take_level_ground(job, body, model, &particles));
  }
  std::vector<LoadedSurface> surfaces;
  PetscCall(find_load_faces(job.comm, config, &model->bodies, &model->face_count, &surfaces));
  if (config.stage.number <= 1)
    for (const int n : loads_from_stage(config, 1))
      PetscCall(job.log.line(describe_surface(config, n, surfaces[n])));
  for (const auto& rigid : config.rigids)
    if (!rigid.absent)
      PetscCall(load_shape(job, is_new(config, rigid) ? "rigid " + rigid.name : "", rigid.shape, {}, {},
                           &model->rigids.emplace_back()));
  for (auto* all : {&model->bodies, &model->rigids})
    for (BodyParticles& particles : *all)
      for (std::size_t k = 0; k < particles.position.size(); ++k)
        particles.position[k] -= config.mesh.lower[k % config.dim];
  PetscCall(distribute(job.comm, config, mesh, model));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
