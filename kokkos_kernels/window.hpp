#pragma once
// The window of a patch: the nodes that its particles reach while they drift, copied to a team's scratch
// memory.

#include "particle_to_node.hpp"

namespace mpm {

/// Threads of a team that works on a patch.
template <class Space>
inline constexpr int team_threads = is_device<Space> ? 128 : 1;

/// Place in the window of the node k steps from the first one that a particle reaches.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION int window_place(const Coord<Dim>& cell, const AxisWeights<T> (&a)[Dim],
                                        const Vector<int, Dim>& k) {
  int n = 0;
  for (int d = Dim - 1; d >= 0; --d) n = n * Patch<Dim>::window_edge + cell[d] + a[d].first + k[d] + 1;
  return n;
}

/// Coordinates in the patch of a place in the window, from -1 to edge + 2.
template <int Dim>
KOKKOS_INLINE_FUNCTION Coord<Dim> window_coord(int n) {
  Coord<Dim> c{};
  for (int d = 0; d < Dim; ++d, n /= Patch<Dim>::window_edge) c[d] = n % Patch<Dim>::window_edge - 1;
  return c;
}

}  // namespace mpm
