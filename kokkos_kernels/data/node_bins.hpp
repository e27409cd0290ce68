#pragma once
// Bins about nodes (P2GPlan::about_nodes): which nodes have one.

#include "data/patches.hpp"

namespace mpm {

/// The last node along each direction that has a bin. The nodes at an upper wall, which belong to no cell,
/// have bins too: the grid has a ring of patches outside. At other upper sides particles stay in the last
/// cell, with a coordinate of up to 1.
template <class T, int Dim>
Coord<Dim> last_bins(const Grid<T, Dim>& grid) {
  Coord<Dim> last;
  for (int d = 0; d < Dim; ++d) last[d] = grid.cells[d] - (is_mirror(grid.wall[d][1]) ? 0 : 1);
  return last;
}

}  // namespace mpm
