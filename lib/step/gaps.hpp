#pragma once
// Cells without soil inside the soil: where it has come apart.

#include <array>
#include <vector>

#include "transfer/filled_cells.hpp"

namespace mpm {

struct Gaps {
  long filled = 0, empty = 0;  // cells that hold soil; gaps
};

/// Counts the gaps in a mesh of so many cells, which repeats itself along periodic directions. A gap is a
/// cell without soil and without a rigid that lies in a run of at most two such cells along some axis,
/// between two cells with soil that are inside the soil themselves: along each other axis, a cell with soil
/// or the side of the mesh lies within two cells on both sides of them. So a notch in the surface counts only
/// below its first cell. A patch may be there several times, with a part of its cells each.
template <int Dim>
Gaps count_gaps(const std::vector<FilledPatch>& patches, const std::array<int, 3>& cells,
                const std::array<bool, 3>& periodic = {});

}  // namespace mpm
