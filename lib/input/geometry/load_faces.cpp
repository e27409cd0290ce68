#include "input/geometry/load_faces.hpp"

#include "common/collectives.hpp"
#include "common/presence.hpp"
#include "common/text.hpp"
#include "data/face_terms.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {
namespace {

/// Bodies for a search as they are when a stage begins, by their particles at the start of the run.
std::vector<SearchedBody> searched(const Config& config, const std::vector<BodyParticles>& bodies,
                                   int stage) {
  std::vector<SearchedBody> all(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    all[b].spacing = bodies[b].spacing;
    all[b].on_all_ranks = config.bodies[b].shape.kind == ShapeKind::particles;
    if (is_present(config.stage, config.bodies[b].name, stage)) all[b].position = bodies[b].position;
  }
  return all;
}

/// Most loads that later stages bring to the particles of one body.
int most_of_later_stages(const Config& config) {
  std::vector<int> counts(config.bodies.size());
  for (const LoadConfig& load : config.loads)
    if (load.stage > 1) ++counts[load.body];
  return counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
}

}  // namespace

std::vector<int> loads_from_stage(const Config& config, int stage) {
  std::vector<int> loads;
  for (int n = 0; n < static_cast<int>(config.loads.size()); ++n)
    if (config.loads[n].stage == stage) loads.push_back(n);
  return loads;
}

LoadedSurface sum_faces(const std::vector<FreeFace>& faces, int dim) {
  LoadedSurface sum;
  for (const FreeFace& face : faces) {
    sum.particles += 1, sum.area += face.area;
    for (int d = 0; d < dim; ++d) sum.vector[d] += face.vector[d];
  }
  return sum;
}

PetscErrorCode sum_surface(MPI_Comm comm, LoadedSurface* surface) {
  PetscFunctionBeginUser;
  double sums[5] = {double(surface->particles), surface->area, surface->vector[0], surface->vector[1],
                    surface->vector[2]};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_DOUBLE, MPI_SUM, comm));
  *surface = {std::lround(sums[0]), sums[1], {sums[2], sums[3], sums[4]}};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_load_faces(MPI_Comm comm, const Config& config, std::vector<BodyParticles>* bodies,
                               int* face_count, std::vector<LoadedSurface>* surfaces) {
  PetscFunctionBeginUser;
  *face_count = 0;
  surfaces->assign(config.loads.size(), {});
  if (config.loads.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  const int dim = config.dim, width = face_places(dim).size;
  const std::vector<int> loads = loads_from_stage(config, 1);
  const std::vector<SearchedBody> soil = searched(config, *bodies, 1);
  std::vector<std::vector<FreeFace>> faces;
  PetscCall(find_free_faces(comm, config, soil, loads, &faces));
  std::vector<std::vector<std::vector<double>>> found(bodies->size());  // numbers of FaceTerms, by particle
  for (std::size_t b = 0; b < bodies->size(); ++b) found[b].resize((*bodies)[b].position.size() / dim);
  std::size_t most = 0;
  for (std::size_t n = 0; n < loads.size(); ++n) {
    const int body = config.loads[loads[n]].body;
    for (const FreeFace& face : faces[n]) {
      auto& all = found[body][face.particle];
      const std::vector<double> numbers = numbers_of(face, dim, loads[n]);
      all.insert(all.end(), numbers.begin(), numbers.end());
      most = std::max(most, all.size() / width);
    }
    (*surfaces)[loads[n]] = sum_faces(faces[n], dim);
    if (!soil[body].on_all_ranks) PetscCall(sum_surface(comm, &(*surfaces)[loads[n]]));
  }
  *face_count = static_cast<int>(most);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, face_count, 1, MPI_INT, MPI_MAX, comm));
  if (const int later = most_of_later_stages(config); later > 0)
    *face_count = std::max(*face_count, std::min(*face_count + later, k_most_faces));
  for (std::size_t b = 0; b < bodies->size() && *face_count > 0; ++b) {
    BodyParticles& body = (*bodies)[b];
    body.faces.clear();
    for (auto& particle : found[b]) {
      particle.resize(*face_count * width, 0.0);
      PetscCallCXX(body.faces.insert(body.faces.end(), particle.begin(), particle.end()));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_surface(MPI_Comm comm, const Config& config, const std::vector<BodyParticles>& bodies,
                            int load, LoadedSurface* surface) {
  PetscFunctionBeginUser;
  std::vector<std::vector<FreeFace>> faces;
  PetscCall(
      find_free_faces(comm, config, searched(config, bodies, config.loads[load].stage), {load}, &faces));
  *surface = sum_faces(faces[0], config.dim);
  PetscCall(sum_surface(comm, surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::string describe_surface(const Config& config, int load, const LoadedSurface& surface) {
  const LoadConfig& of = config.loads[load];
  return formatted("load %s: on %ld particles of body %s, area %.9g %s, as a vector out of the body (%s)",
                   of.name.c_str(), surface.particles, config.bodies[of.body].name.c_str(), surface.area,
                   config.dim == 2 && config.geometry == Geometry::plane_strain ? "m" : "m2",
                   text_of(surface.vector, config.dim).c_str());
}

}  // namespace mpm
