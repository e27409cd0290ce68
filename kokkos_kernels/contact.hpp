#pragma once
// Contact of the soil with a rigid body at a node, and the walls of the mesh.

#include "nodes.hpp"

namespace mpm {

/// Which sides of the mesh a node lies on or outside of: bit 2 d + side.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION unsigned sides_of(const Grid<T, Dim>& grid, const Coord<Dim>& node) {
  unsigned sides = 0;
  for (int d = 0; d < Dim; ++d) {
    if (node[d] <= 0) sides |= 1u << (2 * d);
    if (node[d] >= grid.cells[d]) sides |= 2u << (2 * d);
  }
  return sides;
}

/// Velocity that the walls allow: no normal component at a roller, none at all where fixed.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void apply_walls(const Grid<T, Dim>& grid, unsigned sides, Vector<T, Dim>& v) {
  if (sides == 0) return;
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!(sides >> (2 * d + side) & 1u)) continue;
      if (grid.wall[d][side] == Wall::roller) v[d] = 0;
      if (grid.wall[d][side] == Wall::fixed) v = filled<T, Dim>(0);
    }
}

/// Inward unit normal of a rigid body at a node from its mass gradient (Eq. 3), whose sign points out of the
/// body. The mirrored half of a body at a roller is missing, so the gradient's component normal to it is left
/// out. False where the gradient says nothing: in the interior of the body it is round-off, or points to its
/// far face.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool inward_normal(const Grid<T, Dim>& grid, unsigned sides, T mass,
                                          Vector<T, Dim>& n) {
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side)
      if ((sides >> (2 * d + side) & 1u) && grid.wall[d][side] == Wall::roller) n[d] = 0;
  const T length = Kokkos::sqrt(dot(n, n));
  constexpr T k_interior = T(0.05);  // of the mass a cell's edge
  if (!(length > k_interior * mass)) return false;
  for (int d = 0; d < Dim; ++d) n[d] /= -length;
  return true;
}

/// What a contact needs to know of the interface at a node.
template <class T>
struct Interface {
  T shear_speed;  // m/s: shear limit x area x dt / nodal mass, the largest change of the tangential velocity
  T friction;     // -, negative: none
};

/// Correction dV of the soil's velocity v at a node: none where they part;
/// v_r velocity of the rigid, n inward unit normal.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Vector<T, Dim> contact_correction(const Vector<T, Dim>& v, const Vector<T, Dim>& v_r,
                                                         const Vector<T, Dim>& n,
                                                         const Interface<T>& interface) {
  Vector<T, Dim> relative, change = filled<T, Dim>(0);
  for (int d = 0; d < Dim; ++d) relative[d] = v[d] - v_r[d];
  const T approach = dot(relative, n);
  if (!(approach > 0)) return change;
  Vector<T, Dim> slip;
  for (int d = 0; d < Dim; ++d) slip[d] = relative[d] - approach * n[d];
  const T speed = Kokkos::sqrt(dot(slip, slip));
  T largest = interface.shear_speed;
  if (interface.friction >= 0) largest = Kokkos::fmin(largest, interface.friction * approach);
  const T share = largest >= speed ? T(1) : largest / speed;
  for (int d = 0; d < Dim; ++d) change[d] = -approach * n[d] - share * slip[d];
  return change;
}

}  // namespace mpm
