#pragma once
// Contact of the soil at a node.

#include "data/impulse_terms.hpp"
#include "physics/walls.hpp"

namespace mpm {

/// Inward unit normal of a rigid body at a node from its mass gradient (Eq. 3), whose sign points out of the
/// body, without what the mirrored half of the body at a roller cancels. False where the gradient says
/// nothing: in the interior of the body it is round-off, or points to its far face.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool inward_normal(const Grid<T, Dim>& grid, unsigned sides, T mass,
                                          Vector<T, Dim>& n) {
  cancel_at_rollers(grid, sides, n);
  const T length = Kokkos::sqrt(dot(n, n));
  constexpr T k_interior = T(0.05);  // of the mass a cell's edge
  if (!(length > k_interior * mass)) return false;
  const T factor = -1 / length;
  for (int d = 0; d < Dim; ++d) n[d] *= factor;
  return true;
}

/// How far beyond a node the soil begins along the normal [cells], negative where the node is in it, from the
/// soil's volume over a cell's edge and its area [the same units] at the node: for a plane face across the
/// node's cells the integrals of S_i are (1 - h)^2 / 2 and 1 - h. A face that covers a part of the cells
/// scales both, and an inclined one hardly changes their ratio.
template <class T>
KOKKOS_INLINE_FUNCTION T surface_depth(T volume, T area) {
  if (2 * volume <= area) return 1 - 2 * volume / area;
  if (!(area > 0)) return -1;
  const T ratio = volume / area;
  return 2 / (ratio + Kokkos::sqrt(ratio * ratio + 2)) - 1;
}

/// Fraction of the normal correction at a gap [m] between body and soil (the "Geo-contact" penalty of Ma,
/// Wang and Randolph 2014, in the form 1 - (gap/reach)^k): 1 in touch, 0 from `reach` on.
template <class T>
KOKKOS_INLINE_FUNCTION T gap_scaling(T gap, T reach, T exponent) {
  if (gap <= 0) return 1;
  return gap < reach ? 1 - Kokkos::pow(gap / reach, exponent) : T(0);
}

/// Normal impulses of the steps before at a place, over nodal mass: their sum by weight, the sum of the
/// weights, and the impulse that friction has not used.
template <class T>
struct Pressed {
  T sum = 0, weight = 0, store = 0;
};

/// Share that a step keeps of one of ImpulseTerms; fresh: weight of the step in the mean. The store fades
/// slowly, so that all of it serves soil that slides, and none of it a contact much later.
template <class T>
KOKKOS_INLINE_FUNCTION T kept_share(int term, T fresh) {
  constexpr T k_longer = 100;
  return 1 - (term == ImpulseTerms::store ? fresh / k_longer : fresh);
}

/// Normal impulse whose fraction friction may stop in this step; stop: that of this step, fresh: its weight.
/// The impulse of a node rings with the waves of its cells, and a body that sticks on the whole must not slip
/// in each trough: friction takes the mean over some steps, from the first step on that soil is there, as far
/// as it has not used the impulses before. The sum of what it uses is never above that of the impulses.
template <class T>
KOKKOS_INLINE_FUNCTION T usable_impulse(Pressed<T>& pressed, T fresh, T stop) {
  stop = Kokkos::fmax(T(0), stop);
  pressed.sum += fresh * stop;
  pressed.weight += fresh;
  pressed.store += stop;
  return Kokkos::fmin(pressed.store, pressed.sum / pressed.weight);
}

/// Opponent of the soil at a node, such as the surface of a rigid body.
template <class T, int Dim>
struct Opponent {
  Vector<T, Dim> velocity;   // m/s, at the node
  Vector<T, Dim> normal;     // -, from the soil into it, of length 1
  T area = 0;                // m2 (m in 2D), of the soil's boundary towards it
  T gap = 0;                 // m, between the soil and it, where the law has a reach
  T share = 1;               // -, its mass over its and the soil's: 1 for a rigid, which does not yield
  bool within_soil = false;  // more than half a cell from the node: it is not stopped, and nothing presses it
};

/// Interface at a node, as the contact takes it.
template <class T>
struct Interface {
  T shear_speed;   // m/s: shear limit x area x dt / nodal mass, the largest change of the tangential velocity
  T friction;      // -, negative: none
  T pressing = 0;  // m/s: what the soil's own force and weight press towards the rigid x dt / nodal mass
  T fresh = 1;     // -, share of this step in the mean normal impulse
  T carried = 0;   // m/s: part of the normal impulse over nodal mass that the water in the pores carries
  Pressed<T> pressed{};  // m/s: normal impulses over nodal mass
  T gap_scaling = 1;     // -, fraction of the normal correction
  bool separates = true;
  enum class Shear { by_velocity, none, acts };
  Shear shear = Shear::by_velocity;  // whether it acts: by the velocities, or as a light body has it
  T stopped = 0, held = 0;  // -, fractions of the approach and of the slip that the contact takes away
};

/// Whether shear acts at a node: while the node moves in or is pressed in. approach, slip: parts of its
/// velocity relative to the opponent [m/s].
template <class T>
KOKKOS_INLINE_FUNCTION bool feels_shear(T approach, T slip, bool within_soil, const Interface<T>& interface) {
  constexpr T k_leaves = T(0.1);  // of the slip: a node in the soil that moves away faster is not in touch
  constexpr T k_along = T(1e-6);  // of the slip: a motion along the face is along it but for round-off
  // Share of the slip by which round-off presses a node whose forces balance, towards the rigid or away.
  constexpr T k_balanced = sizeof(T) == sizeof(double) ? T(1e-10) : T(1e-6);
  return !interface.separates || approach > k_along * slip || interface.pressing > k_balanced * slip ||
         (within_soil && -approach < k_leaves * slip);
}

/// Correction dV of the soil's velocity v at a node. No soil moves into the opponent. Shear acts while it
/// moves in or is pressed in. Friction is a fraction of the usable normal impulse. Of the relative velocity
/// that the contact takes away, the soil takes the opponent's share: the impulses on both are opposite.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Vector<T, Dim> contact_correction(const Vector<T, Dim>& v,
                                                         const Opponent<T, Dim>& other,
                                                         Interface<T>& interface) {
  const Vector<T, Dim>& n = other.normal;
  Vector<T, Dim> relative, change = filled<T, Dim>(0);
  for (int d = 0; d < Dim; ++d) relative[d] = v[d] - other.velocity[d];
  const T approach = dot(relative, n);
  const T stop = other.share * (other.within_soil ? T(0) : interface.gap_scaling) *
                 (interface.separates ? Kokkos::fmax(T(0), approach) : approach);
  Vector<T, Dim> slip;
  for (int d = 0; d < Dim; ++d) slip[d] = relative[d] - approach * n[d];
  const T speed = Kokkos::sqrt(dot(slip, slip));
  const bool touches = interface.shear == Interface<T>::Shear::by_velocity
                           ? feels_shear(approach, speed, other.within_soil, interface)
                           : interface.shear == Interface<T>::Shear::acts;
  T largest = touches ? interface.shear_speed : T(0);
  if (interface.friction >= 0) {
    const T normal = usable_impulse(interface.pressed, interface.fresh, stop - interface.carried);
    largest = Kokkos::fmin(interface.shear_speed, interface.friction * normal);
  }
  const T hold = other.share * speed;  // change of the soil's velocity that ends the slip
  const T factor = largest >= hold ? T(1) : largest / hold;
  interface.stopped = approach > 0 || !interface.separates
                          ? other.share * (other.within_soil ? T(0) : interface.gap_scaling)
                          : T(0);
  interface.held = other.share * factor;
  if (interface.friction > 0) interface.pressed.store -= factor * hold / interface.friction;
  for (int d = 0; d < Dim; ++d) change[d] = -stop * n[d] - factor * (other.share * slip[d]);
  return change;
}

}  // namespace mpm
