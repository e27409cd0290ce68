#pragma once
// The size of a patch, for code with and without Kokkos.

namespace mpm {

/// Cells along the edge of a patch: a power of two, and as many cells in 2D as in 3D.
constexpr int patch_edge(int dim) { return dim == 2 ? 8 : 4; }

}  // namespace mpm
