#include "mesh/background.hpp"

#include <algorithm>
#include <limits>

namespace mpm {

double patch_count(const MeshConfig& mesh, int dim) {
  double count = 1;
  for (int d = 0; d < dim; ++d) {
    const int along = (mesh.cells[d] + patch_edge(dim) - 1) / patch_edge(dim) + 2;  // with the ring
    count *= along;
  }
  return count;
}

std::array<int, 3> ranks_along(int ranks, const std::array<int, 3>& patches) {
  for (; ranks > 1; --ranks) {
    std::array<int, 3> best{};
    double least = std::numeric_limits<double>::infinity();
    for (int x = 1; x <= std::min(ranks, patches[0]); ++x)
      for (int y = 1; x * y <= ranks && y <= patches[1]; ++y) {
        const int z = ranks / (x * y);
        if (x * y * z != ranks || z > patches[2]) continue;
        const double cut = double(x - 1) * patches[1] * patches[2] + double(y - 1) * patches[0] * patches[2] +
                           double(z - 1) * patches[0] * patches[1];
        if (cut < least) least = cut, best = {x, y, z};
      }
    if (best[0] > 0) return best;
  }
  return {1, 1, 1};
}

BackgroundMesh::~BackgroundMesh() {
  PetscBool up = PETSC_FALSE;
  if (PetscInitialized(&up) != PETSC_SUCCESS || !up) return;
  if (da_ != nullptr) (void)DMDestroy(&da_);
  if (cut_ != MPI_COMM_NULL) MPI_Comm_free(&cut_);
}

PetscErrorCode BackgroundMesh::create(MPI_Comm comm, const MeshConfig& mesh, int dim) {
  PetscFunctionBeginUser;
  PetscMPIInt ranks = 1, rank = 0;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  whole_ = comm;
  dim_ = dim;
  for (int d = 0; d < dim; ++d) patches_[d] = (mesh.cells[d] + patch_edge(dim) - 1) / patch_edge(dim);
  ranks_ = ranks_along(ranks, patches_);
  PetscCall(DMDestroy(&da_));
  if (cut_ != MPI_COMM_NULL) PetscCallMPI(MPI_Comm_free(&cut_));
  const bool takes_part = rank < ranks_[0] * ranks_[1] * ranks_[2];
  PetscCallMPI(MPI_Comm_split(comm, takes_part ? 0 : MPI_UNDEFINED, rank, &cut_));
  if (!takes_part) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMDACreate(cut_, &da_));
  PetscCall(DMSetDimension(da_, dim));
  PetscCall(DMDASetSizes(da_, patches_[0], patches_[1], patches_[2]));
  PetscCall(DMDASetNumProcs(da_, ranks_[0], ranks_[1], dim == 3 ? ranks_[2] : PETSC_DECIDE));
  PetscCall(DMDASetBoundaryType(da_, DM_BOUNDARY_GHOSTED, DM_BOUNDARY_GHOSTED,
                                dim == 3 ? DM_BOUNDARY_GHOSTED : DM_BOUNDARY_NONE));
  PetscCall(DMDASetStencilType(da_, DMDA_STENCIL_BOX));
  PetscCall(DMDASetStencilWidth(da_, 1));
  PetscCall(DMDASetDof(da_, 1));
  PetscCall(DMSetUp(da_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::array<int, 3> BackgroundMesh::patches_with_ring() const {
  std::array<int, 3> all = patches_;
  for (int d = 0; d < dim_; ++d) all[d] += 2;
  return all;
}

PetscErrorCode BackgroundMesh::owners(Owners* owners) const {
  PetscFunctionBeginUser;
  const PetscInt* extents[3] = {nullptr, nullptr, nullptr};
  if (da_ != nullptr) PetscCall(DMDAGetOwnershipRanges(da_, &extents[0], &extents[1], &extents[2]));
  std::array<std::vector<int>, 3> part;  // of each patch along each direction, the ring included
  for (int d = 0; d < 3; ++d) {
    std::vector<int> extent(ranks_[d], patches_[d]);
    for (int n = 0; n < ranks_[d] && extents[d] != nullptr; ++n) extent[n] = static_cast<int>(extents[d][n]);
    PetscCallMPI(MPI_Bcast(extent.data(), ranks_[d], MPI_INT, 0, whole_));
    for (int n = 0; n < ranks_[d]; ++n) part[d].insert(part[d].end(), extent[n], n);
    if (d >= dim_) continue;
    part[d].insert(part[d].begin(), part[d].front());
    part[d].push_back(part[d].back());
  }
  owners->clear();
  for (const int z : part[2])
    for (const int y : part[1])
      for (const int x : part[0]) owners->push_back((z * ranks_[1] + y) * ranks_[0] + x);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
