#pragma once
// Where a rigid body is.

#include "base/types.hpp"

namespace mpm {

/// Takes points and directions of a rigid body, as it was placed at the start, to where they are now, and
/// back. The body translates, so that directions stay as they are.
template <int Dim>
struct RigidPose {
  Vector<double, Dim> displacement;  // m, since the start

  /// Where a point of the body is now; x and the place are in m.
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> to_world(const Vector<double, Dim>& x) const {
    Vector<double, Dim> place;
    for (int d = 0; d < Dim; ++d) place[d] = x[d] + displacement[d];
    return place;
  }
  /// Which point of the body, as it was placed at the start, is at a place now. x(d): component d of the
  /// place; both are in m. Where x(d) is a product, the compiler may round it and the difference once.
  template <class Component>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> to_body(const Component& x) const {
    Vector<double, Dim> point;
    for (int d = 0; d < Dim; ++d) point[d] = x(d) - displacement[d];
    return point;
  }
  /// Direction now of a direction of the body, such as a normal of its surface.
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> turn_to_world(const Vector<double, Dim>& direction) const {
    return direction;
  }
  /// Direction of the body, as it was placed at the start, of a direction now.
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> turn_to_body(const Vector<double, Dim>& direction) const {
    return direction;
  }
  /// Moves the body by a way [m].
  KOKKOS_INLINE_FUNCTION void move(const Vector<double, Dim>& way) {
    for (int d = 0; d < Dim; ++d) displacement[d] += way[d];
  }
  /// Way [m] from another pose to this one, along which the components of a wrench do work.
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> way_from(const RigidPose& other) const {
    Vector<double, Dim> way;
    for (int d = 0; d < Dim; ++d) way[d] = displacement[d] - other.displacement[d];
    return way;
  }
  /// This pose for lengths in cells; spacing is in m.
  KOKKOS_INLINE_FUNCTION RigidPose in_cells(double spacing) const {
    RigidPose pose;
    for (int d = 0; d < Dim; ++d) pose.displacement[d] = displacement[d] / spacing;
    return pose;
  }
};

}  // namespace mpm
