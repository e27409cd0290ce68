#pragma once
// A node on sides of the mesh that act, and what the sides have given it.

#include "data/sides.hpp"

namespace mpm {

/// A node on sides that act in a step.
template <int Dim>
struct SideNode {
  Coord<Dim> at;
  unsigned sides;   // the acting ones that it lies on
  unsigned ends;    // all that it lies on and that end the mesh, as sides_of
  double mass, dt;  // kg, s
  double fresh;     // -, weight of a step in the mean normal impulse
  bool counts;      // this rank answers for it
  bool keeps;       // the step itself, not a rehearsal, which leaves no trace

  KOKKOS_INLINE_FUNCTION bool on(int side) const { return sides >> side & 1u; }
  /// Share of a cell's face that the node has of a side: half of it along each other side that it lies on.
  KOKKOS_INLINE_FUNCTION double share_of(int side) const {
    double share = 1;
    for (int d = 0; d < Dim; ++d)
      if (d != side / 2 && (ends >> (2 * d) & 3u) != 0) share /= 2;
    return share;
  }
};

/// Adds the impulse [N s] of a side on a node to what the side has given, and its work.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void book(double* kept, const SideNode<Dim>& node, const Vector<T, Dim>& v_old, int k,
                                 double impulse, double v) {
  using S = SideTerms<Dim>;
  if (!node.counts || !node.keeps) return;
  kept[S::impulse + k] += impulse;
  kept[S::work] += impulse * (double(v_old[k]) + v) / 2;
}

}  // namespace mpm
