#pragma once
// Contact between two velocity fields at a node (Bardenhagen et al. 2001), with the gap by volume and area.

#include "data/interfaces.hpp"
#include "physics/contact.hpp"

namespace mpm {

/// How soil lies round a node: the centre of its volume there [cells from the node], and the covariance of
/// its places [cells2].
template <class T, int Dim>
struct SoilCloud {
  Vector<T, Dim> centre;
  T spread[Dim][Dim];

  /// A measure of how far the soil reaches along n, of length 1 [cells]: five standard deviations beyond its
  /// centre. Of boxes they would be 1.73; more of them tell better which body is long along a false normal.
  KOKKOS_INLINE_FUNCTION T reach(const Vector<T, Dim>& n) const {
    constexpr T k_deviations = T(5);
    T square = 0;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) square += n[i] * spread[i][j] * n[j];
    return dot(centre, n) + k_deviations * Kokkos::sqrt(Kokkos::fmax(T(0), square));
  }
};

/// Soil of a velocity field at a node.
template <class T, int Dim>
struct InterfaceSide {
  int field, i;             // i: the node
  T mass, moving;           // kg; with that of the sides that it is welded to
  Vector<T, Dim> velocity;  // m/s, at the end of the step, as far as it is known
  int welded;               // the first side that it moves as one with; else its own number
  Vector<T, Dim> area;      // m2, of its boundary, out of it
  T volume;                 // m3
  T strength;               // Pa, where a law asks for it
  SoilCloud<T, Dim> cloud;
  Vector<double, Dim> force;  // N, of other fields
};

/// How two fields lie to each other at a node.
template <class T, int Dim>
struct Meeting {
  Vector<T, Dim> normal;  // out of the first, of length 1
  T gap, area;            // m, negative where they overlap; m2
};

/// Area in which the faces of two bodies lie on each other at a node [m2], from the areas of the faces there
/// and their depths [cells] (surface_depth). A face that is as wide as the node's cells has at the node the
/// part 1 - |depth| of a cell's face. So the areas over their parts are how wide the faces are: the narrower
/// one counts; and of faces that lie apart, or overlap, the mean of their parts counts, which over all nodes
/// is the whole.
template <class T>
KOKKOS_INLINE_FUNCTION T shared_area(T of_a, T depth_a, T of_b, T depth_b) {
  constexpr T k_least = T(0.1);  // less is hardly known
  const T part_a = Kokkos::fmax(k_least, 1 - Kokkos::fabs(depth_a)),
          part_b = Kokkos::fmax(k_least, 1 - Kokkos::fabs(depth_b));
  return Kokkos::fmin(of_a / part_a, of_b / part_b) * (part_a + part_b) / 2;
}

/// Part of a cell's face that a body's boundary at a node covers, 1 where it is a plane face across the
/// node's cells, less at an edge. volume [m3], area [m2] of the body at the node; spacing [m], face [m2] of a
/// cell.
template <class T>
KOKKOS_INLINE_FUNCTION T covered(T volume, T area, T spacing, T face) {
  constexpr T k_least = T(0.05);  // less is hardly known
  const T across = Kokkos::fmax(k_least, 1 - Kokkos::fabs(surface_depth(volume / spacing, area)));
  return Kokkos::fmin(T(1), area / (face * across));
}

/// Normal out of a where two fields meet at a node, of three: that of each field's own boundary, and that of
/// the part of both boundaries which is no outer boundary of the two together. The one along which the fields
/// overlap least counts, as by the separating axis of two convex bodies, less where the boundary is but an
/// edge at the node: the corner of a block on flat ground takes the ground's, wherever in a cell the ground
/// ends, and beams with flush ends take that of the face between them. face [m2]: of a cell. False where no
/// field has a boundary, as deep in soil.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool normal_between(const InterfaceSide<T, Dim>& a, const InterfaceSide<T, Dim>& b,
                                           T spacing, T face, Vector<T, Dim>& normal) {
  constexpr T k_bounds = T(1e-3);   // of a cell's face: less is round-off
  constexpr T k_smaller = T(0.05);  // of the larger area: too little to have a normal
  constexpr T k_even = T(0.02);     // cells, difference of overlaps at which one normal begins to rule
  Vector<T, Dim> of[3];
  T outer_square = 0, along = 0, most = 0;
  for (int d = 0; d < Dim; ++d) {
    const T outer = a.area[d] + b.area[d];
    of[0][d] = a.area[d], of[1][d] = -b.area[d], of[2][d] = a.area[d] - b.area[d];
    outer_square += outer * outer, along += outer * of[2][d];
  }
  const T part = outer_square > k_bounds * k_bounds * face * face ? along / outer_square : T(0);
  for (int d = 0; d < Dim; ++d) of[2][d] = (of[2][d] - part * (a.area[d] + b.area[d])) / 2;
  T size[3], overlap[3], least = Kokkos::Experimental::infinity<T>::value;
  for (int n = 0; n < 3; ++n) size[n] = Kokkos::sqrt(dot(of[n], of[n])), most = Kokkos::fmax(most, size[n]);
  if (!(most > k_bounds * face)) return false;
  const T edge_a = 1 - covered(a.volume, size[0], spacing, face),
          edge_b = 1 - covered(b.volume, size[1], spacing, face);
  const T at_edge[3] = {edge_a, edge_b, Kokkos::fmax(edge_a, edge_b)};  // cells, as if they overlapped more
  for (int n = 0; n < 3; ++n) {
    if (!(size[n] > k_smaller * most)) continue;
    Vector<T, Dim> back;
    for (int d = 0; d < Dim; ++d) of[n][d] /= size[n], back[d] = -of[n][d];
    overlap[n] = a.cloud.reach(of[n]) + b.cloud.reach(back) + at_edge[n];
    least = Kokkos::fmin(least, overlap[n]);
  }
  for (int d = 0; d < Dim; ++d) normal[d] = 0;
  for (int n = 0; n < 3; ++n) {
    if (!(size[n] > k_smaller * most)) continue;
    const T weight = Kokkos::exp(Kokkos::fmax(T(-50), (least - overlap[n]) / k_even));
    for (int d = 0; d < Dim; ++d) normal[d] += weight * of[n][d];
  }
  const T length = Kokkos::sqrt(dot(normal, normal));
  if (!(length > k_bounds)) return false;
  for (int d = 0; d < Dim; ++d) normal[d] /= length;
  return true;
}

/// Normal, gap and area between fields a and b at a node; false where neither has a boundary.
/// spacing [m], face [m2]: of a cell.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool meet(const InterfaceSide<T, Dim>& a, const InterfaceSide<T, Dim>& b, T spacing,
                                 T face, Meeting<T, Dim>& at) {
  if (!normal_between(a, b, spacing, face, at.normal)) return false;
  const T of_a = Kokkos::fmax(T(0), dot(a.area, at.normal)),
          of_b = Kokkos::fmax(T(0), -dot(b.area, at.normal));
  const T depth_a = surface_depth(a.volume / spacing, of_a),
          depth_b = surface_depth(b.volume / spacing, of_b);
  at.area = shared_area(of_a, depth_a, of_b, depth_b);
  at.gap = spacing * (depth_a + depth_b);
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
  if (law.shear_fraction >= 0) {
    const T of_a = law.strong[0] ? a.strength : none, of_b = law.strong[1] ? b.strength : none;
    limit = T(law.shear_fraction) * Kokkos::fmin(of_a, of_b);
  }
  if (law.shear_limit < none) limit = Kokkos::fmin(limit, T(law.shear_limit));
  const T by_area = limit < none ? limit * area * dt : none;
  if (law.friction < 0) return by_area;
  const T coulomb = T(law.friction) * normal + T(law.adhesion) * area * dt;
  return Kokkos::fmin(by_area, coulomb);
}

/// What a pair of fields has had in a step, in rounds [N s]: normal impulse, and that along the face, against
/// the slip of the first.
template <class T, int Dim>
struct SharedImpulse {
  T normal = 0;
  Vector<T, Dim> along{};
};

/// Impulses of a law between fields a and b in a step of dt [s], and of what is welded to them, beyond those
/// of the rounds before. Fields may approach by their gap. Contact is inelastic.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION InterfaceImpulse<T, Dim> impulse_between(const InterfaceLaw& law,
                                                                const InterfaceSide<T, Dim>& a,
                                                                const InterfaceSide<T, Dim>& b,
                                                                const Meeting<T, Dim>& at, T spacing, T dt,
                                                                SharedImpulse<T, Dim>& so_far) {
  constexpr T k_shears = T(0.15);  // cells, gap within which shear acts without a normal impulse
  InterfaceImpulse<T, Dim> out;
  const T mass = a.moving * b.moving / (a.moving + b.moving);
  const bool began = so_far.normal > 0;
  Vector<T, Dim> slip;
  for (int d = 0; d < Dim; ++d) slip[d] = a.velocity[d] - b.velocity[d];
  const T approach = dot(slip, at.normal);
  const T normal = Kokkos::fmax(T(0), so_far.normal + mass * (approach - Kokkos::fmax(T(0), at.gap) / dt));
  Vector<T, Dim> along = filled<T, Dim>(0);
  if (normal > 0 || at.gap < k_shears * spacing)
    for (int d = 0; d < Dim; ++d) along[d] = so_far.along[d] + mass * (slip[d] - approach * at.normal[d]);
  const T size = Kokkos::sqrt(dot(along, along)), most = shear_bound(law, a, b, normal, at.area, dt);
  if (size > most)
    for (int d = 0; d < Dim; ++d) along[d] *= most / size;
  T work = 0;
  for (int d = 0; d < Dim; ++d) {
    const T more = along[d] - so_far.along[d];
    out.on_first[d] = -(normal - so_far.normal) * at.normal[d] - more;
    work += more * (slip[d] - approach * at.normal[d] - more / (2 * mass));
  }
  const bool touched = began || dot(so_far.along, so_far.along) > 0;
  if (!touched && (normal > 0 || size > 0)) out.area = at.area;
  out.work = work;
  so_far = {normal, along};
  return out;
}

}  // namespace mpm
