#pragma once
// The background mesh as a whole, described by a PETSc DMDA whose points are the patches: its extent, its
// natural numbering and its ownership are then aligned to patches by construction.

#include <petscdmda.h>

#include "base/patch_edge.hpp"
#include "mesh/patch_grid.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Patches that a mesh has, with the ring outside it.
double patch_count(const MeshConfig& mesh, int dim);

/// Along how many ranks each direction of a box of patches is cut: as many ranks as can have a patch each, at
/// most `ranks`, with the smallest area between them.
std::array<int, 3> ranks_along(int ranks, const std::array<int, 3>& patches);

/// Owns a DMDA and gives the figures that kernels need of it.
class BackgroundMesh {
 public:
  BackgroundMesh() = default;
  BackgroundMesh(const BackgroundMesh&) = delete;
  BackgroundMesh& operator=(const BackgroundMesh&) = delete;
  ~BackgroundMesh();

  /// Makes the DMDA of the mesh's patches, with a ring of neighbours. Collective.
  PetscErrorCode create(MPI_Comm comm, const MeshConfig& mesh, int dim);
  /// Patches along each direction, with the ring outside the mesh that particles at a wall reach.
  std::array<int, 3> patches_with_ring() const;
  /// The rank that the DMDA gives each patch, the ring outside included: that of the patch beside it.
  /// Collective.
  PetscErrorCode owners(Owners* owners) const;

 private:
  DM da_ = nullptr;  // on the ranks that it is cut for: all, or as many as there are patches for
  MPI_Comm whole_ = MPI_COMM_NULL, cut_ = MPI_COMM_NULL;
  int dim_ = 2;
  std::array<int, 3> patches_{1, 1, 1}, ranks_{1, 1, 1};  // of the mesh, along each direction
};

}  // namespace mpm
