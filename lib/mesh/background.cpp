#include "mesh/background.hpp"

namespace mpm {

double patch_count(const MeshConfig& mesh, int dim) {
  double count = 1;
  for (int d = 0; d < dim; ++d) count *= (mesh.cells[d] + patch_edge(dim) - 1) / patch_edge(dim) + 2;
  return count;
}

BackgroundMesh::~BackgroundMesh() {
  PetscBool up = PETSC_FALSE;
  if (da_ != nullptr && PetscInitialized(&up) == PETSC_SUCCESS && up) (void)DMDestroy(&da_);
}

PetscErrorCode BackgroundMesh::create(MPI_Comm comm, const MeshConfig& mesh, int dim) {
  PetscFunctionBeginUser;
  std::array<PetscInt, 3> patches{1, 1, 1};
  for (int d = 0; d < dim; ++d) patches[d] = (mesh.cells[d] + patch_edge(dim) - 1) / patch_edge(dim);
  PetscCall(DMDestroy(&da_));
  PetscCall(DMDACreate(comm, &da_));
  PetscCall(DMSetDimension(da_, dim));
  PetscCall(DMDASetSizes(da_, patches[0], patches[1], patches[2]));
  PetscCall(DMDASetBoundaryType(da_, DM_BOUNDARY_GHOSTED, DM_BOUNDARY_GHOSTED,
                                dim == 3 ? DM_BOUNDARY_GHOSTED : DM_BOUNDARY_NONE));
  PetscCall(DMDASetStencilType(da_, DMDA_STENCIL_BOX));
  PetscCall(DMDASetStencilWidth(da_, 1));
  PetscCall(DMDASetDof(da_, 1));
  PetscCall(DMSetUp(da_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BackgroundMesh::patches_with_ring(std::array<int, 3>& patches) const {
  PetscFunctionBeginUser;
  PetscInt x, y, z, m, n, p;
  PetscCall(DMDAGetGhostCorners(da_, &x, &y, &z, &m, &n, &p));
  patches = {static_cast<int>(m), static_cast<int>(n), static_cast<int>(p)};
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
