#pragma once
// Nodes whose sites of contact may act until the next rebuild, and the particles that may act there.

#include <cstdint>

#include "base/spaces.hpp"
#include "data/patches.hpp"

namespace mpm {

/// A particle that may come near the face of a rigid body, and the group of the body at the particle's slot.
struct SitePair {
  int group, particle;
};

/// Nodes near the face of a rigid body that soil may come near, group by group: a group is a rigid body at a
/// slot where a contact may be, number (place of the body among those near the slot) * slots + (place of the
/// slot). So steps work with what is near both, not with all nodes and bodies.
template <class Space>
struct SiteList {
  using Memory = typename Space::memory_space;
  bool made = false;                           // since the last rebuild
  int nodes = 0, groups = 0, pairs = 0;        // entries of `node`, `group` and `pair`
  Kokkos::View<std::uint64_t*, Memory> marks;  // [group] bit k: node k of the slot is in the list
  Kokkos::View<std::uint64_t*, Memory>
      open;                              // likewise of those of which sites are open to soil in this step
  Kokkos::View<int*, Memory> first;      // [groups of all bodies and slots + 1] first node of each
  Kokkos::View<int*, Memory> node;       // group * Patch::cells + place in the slot, rising
  Kokkos::View<int*, Memory> group;      // those that have nodes, rising
  Kokkos::View<SitePair*, Memory> pair;  // in the order of slots and cells

  /// Number of node k of a group in the list; -1: it is not there.
  KOKKOS_INLINE_FUNCTION int number(int group_, int k) const {
    const std::uint64_t all = marks(group_);
    if ((all >> k & 1) == 0) return -1;
    return first(group_) + Kokkos::Experimental::popcount_builtin(all & ((std::uint64_t(1) << k) - 1));
  }
};

/// Bits of the nodes from low to high, in a patch's coordinates, that lie in its neighbour number k.
template <int Dim>
KOKKOS_INLINE_FUNCTION std::uint64_t nodes_between(int k, const Coord<Dim>& low, const Coord<Dim>& high) {
  constexpr int edge = Patch<Dim>::edge;
  std::uint64_t bits = 1;
  for (int d = 0; d < Dim; ++d, k /= 3) {
    const int from = (k % 3 - 1) * edge, first = Kokkos::max(0, low[d] - from),
              last = Kokkos::min(edge - 1, high[d] - from);
    std::uint64_t all = 0;
    for (int at = first; at <= last; ++at) all |= bits << (at << (d * Patch<Dim>::log_edge));
    bits = all;
  }
  return bits;
}

}  // namespace mpm
