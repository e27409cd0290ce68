#pragma once
// Where a rigid body is.

#include "data/rotation.hpp"

namespace mpm {

/// Takes points and directions of a rigid body, as it was placed at the start, to where they are now, and
/// back. MayTurn: false where no body of the run turns, so that kernels do without the rotation.
template <int Dim>
struct RigidPose {
  Vector<double, Dim> displacement;  // m, since the start: of the centre of mass, where the body turns
  bool turns = false;                // the body may turn; else it translates, to the bits of a sum
  Vector<double, Dim> centre = {};   // m, about which it turns, at the start
  Rotation<Dim> rotation = {};       // about it, since the start

  /// Where a point of the body is now; x and the place are in m.
  template <bool MayTurn = true>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> to_world(const Vector<double, Dim>& x) const {
    Vector<double, Dim> place;
    if constexpr (MayTurn)
      if (turns) {
        for (int d = 0; d < Dim; ++d) place[d] = x[d] - centre[d];
        place = rotation.turn(place);
        for (int d = 0; d < Dim; ++d) place[d] += centre[d] + displacement[d];
        return place;
      }
    for (int d = 0; d < Dim; ++d) place[d] = x[d] + displacement[d];
    return place;
  }
  /// Which point of the body, as it was placed at the start, is at a place now. x(d): component d of the
  /// place; both are in m. Where x(d) is a product, the compiler may round it and the difference once.
  template <bool MayTurn = true, class Component>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> to_body(const Component& x) const {
    Vector<double, Dim> point;
    if constexpr (MayTurn)
      if (turns) {
        for (int d = 0; d < Dim; ++d) point[d] = x(d) - centre[d] - displacement[d];
        point = rotation.turn_back(point);
        for (int d = 0; d < Dim; ++d) point[d] += centre[d];
        return point;
      }
    for (int d = 0; d < Dim; ++d) point[d] = x(d) - displacement[d];
    return point;
  }
  /// Direction now of a direction of the body, such as a normal of its surface.
  template <bool MayTurn = true>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> turn_to_world(const Vector<double, Dim>& direction) const {
    if constexpr (MayTurn)
      if (turns) return rotation.turn(direction);
    return direction;
  }
  /// Direction of the body, as it was placed at the start, of a direction now.
  template <bool MayTurn = true>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> turn_to_body(const Vector<double, Dim>& direction) const {
    if constexpr (MayTurn)
      if (turns) return rotation.turn_back(direction);
    return direction;
  }
  /// Arm [m] from the centre to a place now.
  template <class Component>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> arm_to(const Component& x) const {
    Vector<double, Dim> arm;
    for (int d = 0; d < Dim; ++d) arm[d] = x(d) - centre[d] - displacement[d];
    return arm;
  }
  /// Moves the body by a way [m].
  KOKKOS_INLINE_FUNCTION void move(const Vector<double, Dim>& way) {
    for (int d = 0; d < Dim; ++d) displacement[d] += way[d];
  }
  /// This pose for lengths in cells; spacing is in m.
  KOKKOS_INLINE_FUNCTION RigidPose in_cells(double spacing) const {
    RigidPose pose = *this;
    for (int d = 0; d < Dim; ++d) {
      pose.displacement[d] = displacement[d] / spacing;
      pose.centre[d] = centre[d] / spacing;
    }
    return pose;
  }
};

}  // namespace mpm
