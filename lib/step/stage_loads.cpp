#include "step/stage_loads.hpp"

#include "common/collectives.hpp"
#include "common/text.hpp"
#include "data/face_terms.hpp"
#include "input/files/checkpoint_particles.hpp"

namespace mpm {
namespace {

SavedField* find(SavedPoints& points, const std::string& name) {
  for (SavedField& field : points.fields)
    if (field.name == name) return &field;
  return nullptr;
}

/// The particles of a state, by body.
struct SortedSoil {
  std::vector<std::vector<std::size_t>> rows;  // of the state, of each body's particles
  std::vector<std::vector<double>> position;   // m, absolute
  std::vector<SearchedBody> bodies;

  SortedSoil(const Config& config, SavedPoints& soil)
      : rows(config.bodies.size()), position(config.bodies.size()), bodies(config.bodies.size()) {
    const int dim = config.dim;
    const std::vector<double> x = positions_of(soil, config.mesh, dim);
    const SavedField *const body = find(soil, "body"), *const half = find(soil, "half_length");
    for (std::size_t p = 0; p < soil.id.size(); ++p) {
      const auto b = static_cast<std::size_t>(body->values[p]);
      rows[b].push_back(p);
      position[b].insert(position[b].end(), &x[p * dim], &x[p * dim] + dim);
      if (half == nullptr || config.bodies[b].shape.angle != 0) continue;
      for (int d = 0; d < dim; ++d)
        bodies[b].width.push_back(2 * config.mesh.spacing * half->values[p * dim + d]);
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      bodies[b].position = position[b];
      bodies[b].spacing = config.mesh.spacing / config.bodies[b].shape.particles_per_cell;
    }
  }
};

/// Puts a face into the first field where the particle has none; whether there is room.
bool store_face(SavedPoints& soil, std::size_t row, int dim, int load, const FreeFace& face) {
  const FacePlaces places = face_places(dim);
  for (int k = 0; k < k_most_faces; ++k) {
    SavedField* const field = find(soil, "face_" + std::to_string(k));
    if (field == nullptr) return false;
    double* const kept = &field->values[row * places.size];
    if (kept[places.load] != 0) continue;
    const std::vector<double> numbers = numbers_of(face, dim, load);
    std::copy(numbers.begin(), numbers.end(), kept);
    return true;
  }
  return false;
}

std::string no_surface(const Config& config, const LoadConfig& load) {
  return formatted("stage %s: no free face of body %s is in the box of load %s, from %s to %s",
                   config.stage.name.c_str(), config.bodies[load.body].name.c_str(), load.name.c_str(),
                   text_of(load.lower, config.dim).c_str(), text_of(load.upper, config.dim).c_str());
}

}  // namespace

PetscErrorCode find_stage_faces(MPI_Comm comm, const Config& config, SavedState* state,
                                std::vector<LoadedSurface>* surfaces, std::string* fault) {
  PetscFunctionBeginUser;
  const std::vector<int> loads = loads_from_stage(config, config.stage.number);
  surfaces->assign(loads.size(), {});
  if (loads.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<std::vector<FreeFace>> faces;
  std::optional<SortedSoil> soil;
  PetscCallCXX(soil.emplace(config, state->soil));
  PetscCall(find_free_faces(comm, config, soil->bodies, loads, &faces));
  std::string full;
  for (std::size_t n = 0; n < loads.size(); ++n) {
    const LoadConfig& load = config.loads[loads[n]];
    for (const FreeFace& face : faces[n])
      if (!store_face(state->soil, soil->rows[load.body][face.particle], config.dim, loads[n], face))
        full = formatted("stage %s: load %s comes to a particle that has %d loads already",
                         config.stage.name.c_str(), load.name.c_str(), k_most_faces);
    (*surfaces)[n] = sum_faces(faces[n], config.dim);
    PetscCall(sum_surface(comm, &(*surfaces)[n]));
    if ((*surfaces)[n].particles == 0) *fault = no_surface(config, load);
  }
  PetscCall(share_text(comm, &full));
  if (!full.empty()) *fault = full;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
