#pragma once
// Contact between two velocity fields at a node (Bardenhagen et al. 2001), with the gap by volume and area.

#include "data/interfaces.hpp"
#include "physics/contact.hpp"

namespace mpm {

/// Soil of a velocity field at a node.
template <class T, int Dim>
struct InterfaceSide {
  int field, i;               // i: the node
  T mass;                     // kg
  Vector<T, Dim> velocity;    // m/s, at the end of the step, as far as it is known
  int welded;                 // the first side that it moves as one with; else its own number
  Vector<T, Dim> area;        // m2, of its boundary, out of it
  T volume;                   // m3
  T strength;                 // Pa, where a law asks for it
  Vector<double, Dim> force;  // N, of other fields
};

/// How two fields lie to each other at a node.
template <class T, int Dim>
struct Meeting {
  Vector<T, Dim> normal;  // out of the first, of length 1
  T gap, area;            // m, negative where they overlap; m2
};

/// Normal, gap and area between fields a and b at a node; false where neither has a boundary, as deep in
/// soil. spacing [m], face [m2]: of a cell. The normal is that of the boundary which covers more of the
/// node's cells: the corner of a block on flat ground takes the ground's.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool meet(const InterfaceSide<T, Dim>& a, const InterfaceSide<T, Dim>& b, T spacing,
                                 T face, Meeting<T, Dim>& at) {
  constexpr T k_bounds = T(1e-3);  // of a cell's face: less is round-off
  const T square_a = dot(a.area, a.area), square_b = dot(b.area, b.area);
  const T most = Kokkos::fmax(square_a, square_b);
  if (!(most > k_bounds * k_bounds * face * face)) return false;
  const T weight_a = power(square_a / most, 4), weight_b = power(square_b / most, 4);
  for (int d = 0; d < Dim; ++d) at.normal[d] = weight_a * a.area[d] - weight_b * b.area[d];
  const T length = Kokkos::sqrt(dot(at.normal, at.normal));
  if (!(length > k_bounds * face)) return false;
  for (int d = 0; d < Dim; ++d) at.normal[d] /= length;
  const T of_a = Kokkos::fmax(T(0), dot(a.area, at.normal)),
          of_b = Kokkos::fmax(T(0), -dot(b.area, at.normal));
  at.area = Kokkos::fmin(of_a, of_b);
  at.gap = spacing * (surface_depth(a.volume / spacing, of_a) + surface_depth(b.volume / spacing, of_b));
  return true;
}

/// Impulses between two fields at a node in a step.
template <class T, int Dim>
struct InterfaceImpulse {
  Vector<T, Dim> on_first{};  // N s; on the second: the opposite
  T area = 0;                 // m2, in touch
  T work = 0;                 // J, that friction takes
};

/// Largest tangential impulse [N s] where the normal one is `normal` [N s].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T shear_bound(const InterfaceLaw& law, const InterfaceSide<T, Dim>& a,
                                     const InterfaceSide<T, Dim>& b, T normal, T area, T dt) {
  const T none = Kokkos::Experimental::infinity<T>::value;
  T limit = none;  // Pa
  if (law.shear_fraction >= 0) limit = T(law.shear_fraction) * Kokkos::fmin(a.strength, b.strength);
  if (law.shear_limit < none) limit = Kokkos::fmin(limit, T(law.shear_limit));
  const T by_area = limit < none ? limit * area * dt : none;
  if (law.friction < 0) return by_area;
  const T coulomb = T(law.friction) * normal + T(law.adhesion) * area * dt;
  return Kokkos::fmin(by_area, coulomb);
}

/// Impulses of a law between fields a and b in a step of dt [s]. Fields may approach by their gap. Contact is
/// inelastic.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION InterfaceImpulse<T, Dim> impulse_between(const InterfaceLaw& law,
                                                                const InterfaceSide<T, Dim>& a,
                                                                const InterfaceSide<T, Dim>& b,
                                                                const Meeting<T, Dim>& at, T spacing, T dt) {
  constexpr T k_shears = T(0.15);  // cells, gap within which shear acts without a normal impulse
  InterfaceImpulse<T, Dim> out;
  const T mass = a.mass * b.mass / (a.mass + b.mass);
  Vector<T, Dim> slip;
  for (int d = 0; d < Dim; ++d) slip[d] = a.velocity[d] - b.velocity[d];
  const T approach = dot(slip, at.normal);
  const T normal = mass * Kokkos::fmax(T(0), approach - Kokkos::fmax(T(0), at.gap) / dt);
  if (!(normal > 0 || at.gap < k_shears * spacing)) return out;
  for (int d = 0; d < Dim; ++d) slip[d] -= approach * at.normal[d];
  const T speed = Kokkos::sqrt(dot(slip, slip));
  const T shear = Kokkos::fmin(mass * speed, shear_bound(law, a, b, normal, at.area, dt));
  const T along = speed > 0 ? shear / speed : T(0);
  for (int d = 0; d < Dim; ++d) out.on_first[d] = -normal * at.normal[d] - along * slip[d];
  if (normal > 0 || shear > 0) out.area = at.area;
  out.work = shear * (speed - shear / (2 * mass));
  return out;
}

/// Impulse that gives two fields one velocity.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION InterfaceImpulse<T, Dim> weld(const InterfaceSide<T, Dim>& a,
                                                     const InterfaceSide<T, Dim>& b) {
  InterfaceImpulse<T, Dim> out;
  const T mass = a.mass * b.mass / (a.mass + b.mass);
  for (int d = 0; d < Dim; ++d) out.on_first[d] = mass * (b.velocity[d] - a.velocity[d]);
  return out;
}

}  // namespace mpm
