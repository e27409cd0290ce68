#include "check/places.hpp"
#include "common/collectives.hpp"
#include "common/text.hpp"
#include "data/face_terms.hpp"
#include "input/geometry/load_faces.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// Places of the particles of all bodies at the start, for a check before the run.
PetscErrorCode read_places(MPI_Comm comm, const Config& config, std::vector<BodyParticles>* bodies) {
  PetscFunctionBeginUser;
  for (const BodyConfig& body : config.bodies) {
    BodyParticles& particles = bodies->emplace_back();
    particles.spacing = config.mesh.spacing / body.shape.particles_per_cell;
    if (body.shape.kind == ShapeKind::particles) {
      ParticleTable table;
      std::string fault;
      PetscCallCXX(fault = read_particles(source_of(body, config), config.mesh, config.dim, table));
      PetscCallCXX(cut_particles(cut_out_of(config, body), config.mesh, config.dim, table));
      particles.position = std::move(table.position);
    } else {
      Lattice lattice;
      PetscCall(fill(body.shape, config.mesh, config.dim, lattice, cut_out_of(config, body),
                     {rank_of(comm), size_of(comm)}));
      particles.position = std::move(lattice.position);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The warning of a load of a later stage that finds no surface where the soil is at the start.
std::string later_warning(const Config& config, const LoadConfig& load) {
  return formatted(
      "warning: -%s_lower: with the soil as it is at the start, without the bodies that stages to %s remove, "
      "no face of body %s is in the box of load %s; the run ends at stage %s if no soil has moved into the "
      "box",
      load.name.c_str(), config.stages[load.stage - 1].c_str(), config.bodies[load.body].name.c_str(),
      load.name.c_str(), config.stages[load.stage - 1].c_str());
}

}  // namespace

PetscErrorCode check_load_faces(MPI_Comm comm, const Config& config, std::vector<std::string>* errors,
                                std::vector<std::string>* warnings) {
  PetscFunctionBeginUser;
  if (config.loads.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<BodyParticles> bodies;
  PetscCall(read_places(comm, config, &bodies));
  int most = 0;
  std::vector<LoadedSurface> surfaces;
  PetscCall(find_load_faces(comm, config, &bodies, &most, &surfaces));
  if (most > k_most_faces)
    errors->push_back(
        formatted("mpm: -loads: given loads of which %d are on one particle, takes at most %d on each", most,
                  k_most_faces));
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const LoadConfig& load = config.loads[n];
    if (load.stage > 1) {
      PetscCall(find_surface(comm, config, bodies, static_cast<int>(n), &surfaces[n]));
      if (surfaces[n].particles == 0) warnings->push_back(later_warning(config, load));
    } else if (surfaces[n].particles == 0) {
      errors->push_back(formatted(
          "mpm: -%s_lower: given \"%s\", takes a lower corner that with -%s_upper \"%s\" makes "
          "a box round some free surface of body %s; no face of its particles is in this one%s",
          load.name.c_str(), text_of(load.lower, config.dim).c_str(), load.name.c_str(),
          text_of(load.upper, config.dim).c_str(), config.bodies[load.body].name.c_str(),
          config.stage.removed_at.empty() ? ""
                                          : formatted(" at the start; -%s_stage takes the stage that "
                                                      "bares one",
                                                      load.name.c_str())
                                                .c_str()));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
