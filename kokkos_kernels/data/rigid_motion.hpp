#pragma once
// How a rigid body moves, and the forces on it.

#include "data/rigid_pose.hpp"

namespace mpm {

/// A force on a rigid body [N], or its impulse [N s], as numbers in a table: the components of the force. A
/// body that turned would have those of the moment behind them.
template <int Dim>
struct alignas(group_alignment<double, Dim>) Wrench {
  static constexpr int force = 0, size = Dim;
  double c[size];
  KOKKOS_INLINE_FUNCTION double& operator[](int k) { return c[k]; }
  KOKKOS_INLINE_FUNCTION const double& operator[](int k) const { return c[k]; }
};

/// Where a rigid body is, and how fast it moves.
template <int Dim>
struct RigidMotion {
  RigidPose<Dim> pose;
  Vector<double, Dim> velocity;  // m/s

  /// Velocity [m/s] of the point of the body that is at a place now. x(d): component d of the place [m], for
  /// which a body that translates does not ask.
  template <class Component>
  KOKKOS_INLINE_FUNCTION const Vector<double, Dim>& velocity_at(const Component& /*x*/) const {
    return velocity;
  }
};

/// How a rigid body resists forces.
template <int Dim>
struct RigidInertia {
  double mass;     // kg
  bool dynamic;    // it moves by the forces on it
  bool held[Dim];  // a plane of symmetry cuts it, across which it does not move
};

/// Members of a rigid body that the end of a step reads.
template <int Dim>
struct MovingRigid {
  RigidMotion<Dim> motion;
  Wrench<Dim> impulse;  // N s, of the soil on it since the host last took it
  Wrench<Dim> force;    // N, external and weight
  RigidInertia<Dim> inertia;

  /// Stores the members that the end of a step changes.
  KOKKOS_INLINE_FUNCTION void keep_in(MovingRigid& rigid) const {
    rigid.motion = motion, rigid.impulse = impulse;
  }
};

}  // namespace mpm
