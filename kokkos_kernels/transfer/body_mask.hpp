#pragma once
// Which bodies count for a measurement, as kernels ask it.

#include "base/copy.hpp"
#include "data/core.hpp"

namespace mpm {

/// Whether a body counts, by list and body.
template <class Space>
using BodyMask = Kokkos::View<char**, Kokkos::LayoutRight, typename Space::memory_space>;

/// The mask of some lists of indices of bodies, of which an empty one means all.
template <class Space, class T, int Dim, class Lists>
BodyMask<Space> mask_of(const Core<Space, T, Dim>& s, const Lists& lists) {
  const std::size_t bodies = s.soil.points.bodies.extent(0);
  const BodyMask<Space> mask("mpm::body_mask", lists.size(), bodies);
  const auto host = Kokkos::create_mirror_view(mask);
  for (std::size_t n = 0; n < lists.size(); ++n) {
    for (std::size_t b = 0; b < bodies; ++b) host(n, b) = lists[n].bodies.empty();
    for (const int b : lists[n].bodies) host(n, b) = 1;
  }
  copy(mask, host);
  return mask;
}

}  // namespace mpm
