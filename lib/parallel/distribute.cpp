#include "parallel/distribute.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/collectives.hpp"
#include "data/face_terms.hpp"
#include "input/geometry/shapes.hpp"
#include "parallel/partition.hpp"
#include "transfer/velocity_gradients.hpp"

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

/// Keeps this rank's part of a body of which every rank has all particles.
void keep_part(LatticePart part, int dim, int faces, BodyParticles& body) {
  const long count = static_cast<long>(body.position.size()) / dim;
  const long from = count * part.number / part.of, to = count * (part.number + 1) / part.of;
  for_each_column(body, [&](std::vector<double>& values, Width kind) {
    const int width = width_of(kind, dim, faces);
    if (!values.empty())
      values = std::vector<double>(values.begin() + from * width, values.begin() + to * width);
  });
}

/// Counts the particles of a body over all ranks; their ids follow each other from `first` on, which moves
/// behind them.
PetscErrorCode number_particles(MPI_Comm comm, int dim, int* first, BodyParticles* body) {
  PetscFunctionBeginUser;
  const long here = static_cast<long>(body->position.size()) / dim;
  long before = 0;
  PetscCallMPI(MPI_Exscan(&here, &before, 1, MPI_LONG, MPI_SUM, comm));
  if (rank_of(comm) == 0) before = 0;  // MPI leaves it undefined
  PetscCallMPI(MPI_Allreduce(&here, &body->total, 1, MPI_LONG, MPI_SUM, comm));
  body->id.resize(here);
  std::iota(body->id.begin(), body->id.end(), *first + static_cast<int>(before));
  *first += static_cast<int>(body->total);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rows of `width` numbers to the ranks `to`; what comes is in the order of ranks, and so of ids.
template <class Number>
PetscErrorCode send_rows(MPI_Comm comm, const std::vector<int>& to, int width, std::vector<Number>* values) {
  PetscFunctionBeginUser;
  const std::size_t size = width * sizeof(Number);
  std::vector<std::vector<char>> out(size_of(comm));
  for (std::size_t p = 0; p < to.size(); ++p) {
    const char* const row = reinterpret_cast<const char*>(&(*values)[p * width]);
    out[to[p]].insert(out[to[p]].end(), row, row + size);
  }
  std::vector<char> in;
  PetscCall(exchange_records(comm, size, out, &in));
  values->resize(in.size() / sizeof(Number));
  std::copy(in.begin(), in.end(), reinterpret_cast<char*>(values->data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode send_to_owners(MPI_Comm comm, const PatchGrid& grid, double spacing, const Owners& owners,
                              int faces, BodyParticles* body) {
  PetscFunctionBeginUser;
  std::vector<int> to;
  for (std::size_t p = 0; p < body->id.size(); ++p)
    to.push_back(owners[patch_of(body->position, p, grid, spacing)]);
  const auto send = [&](std::vector<double>* values, int width) -> PetscErrorCode {
    PetscFunctionBeginUser;
    int present = !values->empty();  // on some rank: this one may have no particle yet
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &present, 1, MPI_INT, MPI_MAX, comm));
    if (present) PetscCall(send_rows(comm, to, width, values));
    PetscFunctionReturn(PETSC_SUCCESS);
  };
  PetscErrorCode failed = PETSC_SUCCESS;
  for_each_column(*body, [&](std::vector<double>& values, Width kind) {
    if (failed == PETSC_SUCCESS) failed = send(&values, width_of(kind, grid.dim, faces));
  });
  PetscCall(failed);
  PetscCall(send_rows(comm, to, 1, &body->id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Particles of all bodies and ranks in each patch.
PetscErrorCode count_loads(MPI_Comm comm, const PatchGrid& grid, double spacing, const Model& model,
                           Loads* loads) {
  PetscFunctionBeginUser;
  loads->assign(grid.count(), 0);
  for (const BodyParticles& body : model.bodies)
    for (std::size_t p = 0; p < body.id.size(); ++p) ++(*loads)[patch_of(body.position, p, grid, spacing)];
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, loads->data(), static_cast<int>(loads->size()), MPI_DOUBLE, MPI_SUM, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Computes the velocity gradients, which need all particles of a body, before most of the particles go.
void take_gradients(const Config& config, BodyParticles& body) {
  if (config.velocity_update != VelocityUpdate::apic || body.velocity.empty()) return;
  if (!body.velocity_gradient.empty()) return;  // a checkpoint has them
  std::vector<double> cells = body.position;
  for (double& x : cells) x /= config.mesh.spacing;
  std::array<int, 3> period{};
  for (int d = 0; d < config.dim; ++d)
    if (is_periodic(config.mesh, d)) period[d] = config.mesh.cells[d];
  body.velocity_gradient = velocity_gradients(cells, body.velocity, config.dim, period);
}

}  // namespace

PetscErrorCode distribute(MPI_Comm comm, const Config& config, const BackgroundMesh& mesh, Model* model) {
  PetscFunctionBeginUser;
  const int dim = config.dim;
  const double spacing = config.mesh.spacing;
  PatchGrid grid{dim, model->patches};
  for (int d = 0; d < dim; ++d) grid.periodic[d] = is_periodic(config.mesh, d);
  for (BodyParticles& body : model->bodies) body.total = static_cast<long>(body.position.size()) / dim;
  if (size_of(comm) == 1) PetscFunctionReturn(PETSC_SUCCESS);

  int first = 0;  // id of the body's first particle
  for (std::size_t b = 0; b < model->bodies.size(); ++b) {
    BodyParticles& body = model->bodies[b];
    if (config.bodies[b].shape.kind == ShapeKind::particles) {
      take_gradients(config, body);
      keep_part({rank_of(comm), size_of(comm)}, dim, model->face_count, body);
    }
    PetscCall(number_particles(comm, dim, &first, &body));
  }
  if (config.partition.kind == PartitionKind::metis) {
    Loads loads;
    PetscCall(count_loads(comm, grid, spacing, *model, &loads));
    PetscCall(cut_graph(comm, grid, loads, {}, &model->owners));
  } else {
    PetscCall(mesh.owners(&model->owners));
  }
  for (BodyParticles& body : model->bodies)
    PetscCall(send_to_owners(comm, grid, spacing, model->owners, model->face_count, &body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
