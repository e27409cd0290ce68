#include "parallel/distribute.hpp"

#include <algorithm>
#include <cmath>

#include "parallel/partition.hpp"
#include "parallel/together.hpp"
#include "velocity_gradients.hpp"

namespace mpm {
namespace {

/// Patch of particle p; one outside the mesh counts to the nearest patch.
long patch_of(const std::vector<double>& position, std::size_t p, const PatchGrid& grid, double spacing) {
  std::array<int, 3> at{};
  for (int d = 0; d < grid.dim; ++d) {
    const double patch = std::floor(position[p * grid.dim + d] / spacing / patch_edge(grid.dim)) + 1;
    at[d] = static_cast<int>(std::clamp(patch, 0.0, grid.patches[d] - 1.0));
  }
  return grid.number(at);
}

/// Keeps `width` numbers of each of these particles; an empty list stays so.
void keep(const std::vector<int>& particles, int width, std::vector<double>& values) {
  if (values.empty()) return;
  std::vector<double> kept;
  kept.reserve(particles.size() * width);
  for (const int p : particles)
    kept.insert(kept.end(), values.begin() + std::size_t(p) * width,
                values.begin() + std::size_t(p + 1) * width);
  values = std::move(kept);
}

/// What follows from all particles of a body, before most of them go.
void take_gradients(const Config& config, BodyParticles& body) {
  if (config.velocity_update != VelocityUpdate::apic || body.velocity.empty()) return;
  std::vector<double> cells = body.position;
  for (double& x : cells) x /= config.mesh.spacing;
  body.velocity_gradient = velocity_gradients(cells, body.velocity, config.dim);
}

}  // namespace

PetscErrorCode distribute(MPI_Comm comm, const Config& config, const BackgroundMesh& mesh, Model* model) {
  PetscFunctionBeginUser;
  const int dim = config.dim, rank = rank_of(comm);
  const PatchGrid grid{dim, model->patches};
  for (BodyParticles& body : model->bodies) body.total = static_cast<long>(body.position.size()) / dim;
  if (size_of(comm) == 1) PetscFunctionReturn(PETSC_SUCCESS);

  if (config.partition.kind == PartitionKind::metis) {
    Loads loads(grid.count());
    for (const BodyParticles& body : model->bodies)
      for (long p = 0; p < body.total; ++p) ++loads[patch_of(body.position, p, grid, config.mesh.spacing)];
    PetscCall(cut_graph(comm, grid, loads, {}, &model->owners));
  } else {
    PetscCall(mesh.owners(&model->owners));
  }
  int first = 0;  // id of the body's first particle
  for (BodyParticles& body : model->bodies) {
    take_gradients(config, body);
    std::vector<int> own;
    for (int p = 0; p < body.total; ++p)
      if (model->owners[patch_of(body.position, p, grid, config.mesh.spacing)] == rank) own.push_back(p);
    for (const int p : own) body.id.push_back(first + p);
    keep(own, dim, body.position), keep(own, dim, body.velocity), keep(own, 1, body.plastic_strain);
    keep(own, dim == 2 ? 4 : 6, body.stress), keep(own, dim * dim, body.velocity_gradient);
    first += static_cast<int>(body.total);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
