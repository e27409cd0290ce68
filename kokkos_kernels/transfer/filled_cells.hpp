#pragma once
// Cells that hold soil, for the notice of gaps.

#include <cstdint>
#include <vector>

#include "base/spaces.hpp"
#include "data/contact_core.hpp"

namespace mpm {

/// The cells of a patch, a bit each by their place in it.
struct FilledPatch {
  long number = 0;          // of the patch in the grid with its ring, whatever its velocity field
  std::uint64_t soil = 0;   // cells in which the centre of a particle of the soil lies
  std::uint64_t rigid = 0;  // cells where particles of a rigid were binned
};

/// The patches of this rank that hold soil or a rigid, in no order.
template <class Space, class T, int Dim>
std::vector<FilledPatch> filled_cells(const ContactCore<Space, T, Dim>& s);

}  // namespace mpm
