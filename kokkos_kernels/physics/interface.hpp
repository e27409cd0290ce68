#pragma once
// Contact between two velocity fields at a node (Bardenhagen et al. 2001), with the gap by volume and area.

#include "data/interfaces.hpp"
#include "physics/contact.hpp"
#include "physics/soil_cloud.hpp"

namespace mpm {

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
  T round_off;                // N s, of its momentum: an impulse below it is none
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

/// Directions that may be the normal out of a where two fields meet at a node: those of the two boundaries,
/// and that of the part of both which is no outer boundary of the two together.
template <class T, int Dim>
struct NormalChoice {
  static constexpr int count = 3;
  Vector<T, Dim> direction[count];
  bool possible[count];
  T penalty[count];  // cells, as if the fields overlapped more along it: where the boundary is but an edge

  KOKKOS_INLINE_FUNCTION NormalChoice(const InterfaceSide<T, Dim>& a, const InterfaceSide<T, Dim>& b,
                                      T spacing, T face) {
    constexpr T k_bounds = T(1e-3);  // of a cell's face: less is round-off
    constexpr T k_smaller =
        T(0.05);  // of a cell's face, for soil that fills the cell: gaps between particles
    for (int d = 0; d < Dim; ++d) direction[0][d] = a.area[d], direction[1][d] = -b.area[d];
    direction[2] = inner(a, b, k_bounds * face);
    T size[count];
    for (int n = 0; n < count; ++n) size[n] = Kokkos::sqrt(dot(direction[n], direction[n]));
    for (int n = 0; n < count; ++n) possible[n] = size[n] > k_bounds * face;
    possible[0] = possible[0] && size[0] > k_smaller * a.volume / spacing;
    possible[1] = possible[1] && size[1] > k_smaller * b.volume / spacing;
    const T apart = possible[0] && possible[1] ? across(size) : T(0);
    for (int n = 0; n < count; ++n)
      for (int d = 0; d < Dim && possible[n]; ++d) direction[n][d] /= size[n];
    const T of_a = possible[0] ? 1 - a.cloud.breadth(direction[0]) : T(1),
            of_b = possible[1] ? 1 - b.cloud.breadth(direction[1]) : T(1);
    penalty[0] = of_a + apart, penalty[1] = of_b + apart;
    penalty[2] = Kokkos::fmax(of_a, of_b);
  }

 private:
  /// Half the difference of the two boundaries, across their sum, which is the outer one [m2].
  KOKKOS_INLINE_FUNCTION static Vector<T, Dim> inner(const InterfaceSide<T, Dim>& a,
                                                     const InterfaceSide<T, Dim>& b, T bounds) {
    Vector<T, Dim> outer, half;
    for (int d = 0; d < Dim; ++d) outer[d] = a.area[d] + b.area[d], half[d] = (a.area[d] - b.area[d]) / 2;
    const T square = dot(outer, outer);
    if (!(square > bounds * bounds)) return half;
    const T part = dot(half, outer) / square;
    for (int d = 0; d < Dim; ++d) half[d] -= part * outer[d];
    return half;
  }

  /// One cell where the boundaries lie across each other, else 0: beams with flush ends have corners at their
  /// face, and neither corner has its normal. No more than that, as gaps between the particles of a body that
  /// fills the node's cells give it a small boundary in any direction.
  KOKKOS_INLINE_FUNCTION T across(const T (&size)[count]) const {
    constexpr T k_opposed = T(0.1);  // cosine between boundaries that lie on each other, at least
    return dot(direction[0], direction[1]) >= k_opposed * size[0] * size[1] ? T(0) : T(1);
  }
};

/// Normal out of a where two fields meet at a node: the direction along which they overlap least, as by the
/// separating axis of two convex bodies. So the corner of a block on flat ground takes the ground's normal,
/// wherever in a cell the ground ends, and beams with flush ends take that of the face between them. face
/// [m2]: of a cell. False where no boundaries lie on each other.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool normal_between(const InterfaceSide<T, Dim>& a, const InterfaceSide<T, Dim>& b,
                                           T spacing, T face, Vector<T, Dim>& normal) {
  constexpr T k_even = T(0.02);  // cells, difference of overlaps at which one normal begins to rule
  constexpr T k_most = T(50);    // as an exponent
  const NormalChoice<T, Dim> of(a, b, spacing, face);
  T overlap[of.count], least = Kokkos::Experimental::infinity<T>::value;
  for (int n = 0; n < of.count; ++n) {
    if (!of.possible[n]) continue;
    Vector<T, Dim> back;
    for (int d = 0; d < Dim; ++d) back[d] = -of.direction[n][d];
    overlap[n] = a.cloud.reach(of.direction[n]) + b.cloud.reach(back) + of.penalty[n];
    least = Kokkos::fmin(least, overlap[n]);
  }
  normal = filled<T, Dim>(0);
  for (int n = 0; n < of.count; ++n) {
    if (!of.possible[n]) continue;
    const T weight = Kokkos::exp(Kokkos::fmax(-k_most, (least - overlap[n]) / k_even));
    for (int d = 0; d < Dim; ++d) normal[d] += weight * of.direction[n][d];
  }
  const T length = Kokkos::sqrt(dot(normal, normal));
  if (!(length > 0)) return false;
  for (int d = 0; d < Dim; ++d) normal[d] /= length;
  return true;
}

/// The cell of a node: its edge [m], its face [m2], and in bodies of revolution the radius of the node [m],
/// else 0.
template <class T>
struct NodeCell {
  T spacing, face, radius;
};

/// Depth [cells] of a body's face that has the normal component n_r along the radius. Beyond surface_depth,
/// which is of a plane: soil of a ring lies on the long or the short side of its face, by the radius of its
/// centre.
template <class T>
KOKKOS_INLINE_FUNCTION T depth_of(T volume, T area, T n_r, const NodeCell<T>& cell) {
  T cells = volume / cell.spacing;
  if (cell.radius > cell.spacing && area > 0) {
    const T q = cells / area;
    const T centre = q <= T(0.5) ? -2 * q / 3 : -q / (1 + q);  // cells along the normal, from the face's node
    cells /= 1 + n_r * centre * cell.spacing / cell.radius;
  }
  return surface_depth(cells, area);
}

/// Normal, gap and area between fields a and b at a node; false where neither has a boundary.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool meet(const InterfaceSide<T, Dim>& a, const InterfaceSide<T, Dim>& b,
                                 const NodeCell<T>& cell, Meeting<T, Dim>& at) {
  if (!normal_between(a, b, cell.spacing, cell.face, at.normal)) return false;
  const T of_a = Kokkos::fmax(T(0), dot(a.area, at.normal)),
          of_b = Kokkos::fmax(T(0), -dot(b.area, at.normal));
  const T depth_a = depth_of(a.volume, of_a, at.normal[0], cell),
          depth_b = depth_of(b.volume, of_b, -at.normal[0], cell);
  at.area = shared_area(of_a, depth_a, of_b, depth_b);
  at.gap = cell.spacing * (depth_a + depth_b);
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

/// Impulses of a pair of fields in the rounds of a step so far [N s]: along the normal, and along the face,
/// against the slip of the first field. touched: one of them was more than round-off.
template <class T, int Dim>
struct SharedImpulse {
  T normal = 0;
  Vector<T, Dim> along{};
  bool touched = false;
};

constexpr double k_shear_gap = 0.15;  // cells, within which shear acts without a normal impulse

/// Area by which a pair shares the impulses between two groups of welded fields [m2]: 0 where the two do not
/// touch.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T sharing_area(const Meeting<T, Dim>& at, T spacing) {
  return at.gap < T(k_shear_gap) * spacing ? at.area : T(0);
}

/// Impulses of a law between fields a and b in a step of dt [s], and of what is welded to them, beyond those
/// of the rounds before. Fields may approach by their gap. Contact is inelastic. part: of what stops the
/// fields, less than 1 where other pairs stop them too.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION InterfaceImpulse<T, Dim> impulse_between(const InterfaceLaw& law,
                                                                const InterfaceSide<T, Dim>& a,
                                                                const InterfaceSide<T, Dim>& b,
                                                                const Meeting<T, Dim>& at, T spacing, T dt,
                                                                SharedImpulse<T, Dim>& so_far, T part = 1) {
  InterfaceImpulse<T, Dim> out;
  const T mass = a.moving * b.moving / (a.moving + b.moving);
  Vector<T, Dim> slip;
  for (int d = 0; d < Dim; ++d) slip[d] = a.velocity[d] - b.velocity[d];
  const T approach = dot(slip, at.normal);
  const T normal =
      Kokkos::fmax(T(0), so_far.normal + part * mass * (approach - Kokkos::fmax(T(0), at.gap) / dt));
  Vector<T, Dim> along = filled<T, Dim>(0);
  if (normal > 0 || at.gap < T(k_shear_gap) * spacing)
    for (int d = 0; d < Dim; ++d)
      along[d] = so_far.along[d] + part * mass * (slip[d] - approach * at.normal[d]);
  const T size = Kokkos::sqrt(dot(along, along)), most = shear_bound(law, a, b, normal, at.area, dt);
  if (size > most)
    for (int d = 0; d < Dim; ++d) along[d] *= most / size;
  T work = 0;
  for (int d = 0; d < Dim; ++d) {
    const T more = along[d] - so_far.along[d];
    out.on_first[d] = -(normal - so_far.normal) * at.normal[d] - more;
    work += more * (slip[d] - approach * at.normal[d] - more / (2 * mass));
  }
  const T least = Kokkos::fmax(a.round_off, b.round_off);
  const bool touches = so_far.touched || normal > least || size > least;
  if (touches && !so_far.touched) out.area = at.area;
  out.work = work;
  so_far = {normal, along, touches};
  return out;
}

}  // namespace mpm
