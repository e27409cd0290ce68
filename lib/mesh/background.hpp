#pragma once
// The background mesh as a whole, described by a PETSc DMDA whose points are the patches: its extent, its
// natural numbering and its ownership are then aligned to patches by construction.

#include <petscdmda.h>

#include "mpm/config.hpp"

namespace mpm {

/// Cells along the edge of a patch.
constexpr int patch_edge(int dim) { return dim == 2 ? 8 : 4; }

/// Patches that a mesh has, with the ring outside it.
double patch_count(const MeshConfig& mesh, int dim);

/// Owns a DMDA and tells what kernels need of it.
class BackgroundMesh {
 public:
  BackgroundMesh() = default;
  BackgroundMesh(const BackgroundMesh&) = delete;
  BackgroundMesh& operator=(const BackgroundMesh&) = delete;
  ~BackgroundMesh();

  /// Makes the DMDA of the mesh's patches, with a ring of neighbours. Collective.
  PetscErrorCode create(MPI_Comm comm, const MeshConfig& mesh, int dim);
  /// Patches along each direction, with the ring outside the mesh that particles at a wall reach.
  PetscErrorCode patches_with_ring(std::array<int, 3>& patches) const;

 private:
  DM da_ = nullptr;
};

}  // namespace mpm
