#pragma once
// How a rigid body moves, and the forces on it.

#include "data/rigid_pose.hpp"

namespace mpm {

/// A force on a rigid body [N] and its moment about the centre of mass [N m], or their impulses, as numbers
/// in a table: the components of the force, and behind them those of the moment. Where no body of a run
/// turns, tables hold the forces alone.
template <int Dim>
struct alignas(group_alignment<double, Dim>) Wrench {
  static constexpr int force = 0, moment = Dim, size = Dim + k_turning_axes<Dim>;
  double c[size];
  KOKKOS_INLINE_FUNCTION double& operator[](int k) { return c[k]; }
  KOKKOS_INLINE_FUNCTION const double& operator[](int k) const { return c[k]; }
};
/// Numbers of a wrench in the tables of a run.
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr int wrench_size(bool turns) {
  return turns ? Wrench<Dim>::size : Wrench<Dim>::moment;
}

/// Where a rigid body is, and how fast it moves.
template <int Dim>
struct RigidMotion {
  RigidPose<Dim> pose;
  Vector<double, Dim> velocity;  // m/s, of the centre of mass where the body turns
  AngularVector<Dim> spin = {};  // rad/s

  /// Velocity [m/s] of the point of the body that is at a place now. x(d): component d of the place [m], for
  /// which a body that translates does not ask. MayTurn: as in RigidPose.
  template <bool MayTurn = true, class Component>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> velocity_at(const Component& x) const {
    if constexpr (MayTurn)
      if (pose.turns) {
        Vector<double, Dim> v = cross(spin, pose.arm_to(x));
        for (int d = 0; d < Dim; ++d) v[d] += velocity[d];
        return v;
      }
    return velocity;
  }
};

/// Way of a rigid body from one pose to another, along which the components of a wrench do work: of the
/// centre [m], and the angle [rad].
template <int Dim>
KOKKOS_INLINE_FUNCTION Vector<double, Wrench<Dim>::size> way_between(const RigidPose<Dim>& from,
                                                                     const RigidPose<Dim>& to) {
  Vector<double, Wrench<Dim>::size> way{};
  for (int d = 0; d < Dim; ++d) way[Wrench<Dim>::force + d] = to.displacement[d] - from.displacement[d];
  if (!to.turns) return way;
  const AngularVector<Dim> angle = to.rotation.way_from(from.rotation);
  for (int k = 0; k < k_turning_axes<Dim>; ++k) way[Wrench<Dim>::moment + k] = angle[k];
  return way;
}

/// Resistance of a rigid body to moments.
template <int Dim>
struct Turning {
  AngularVector<Dim> principal = {};  // kg m2, principal moments of inertia
  Rotation<Dim> axes = {};            // from the principal axes to the body as it was placed at the start
  int axis = k_held;                  // the only one in space about which moments turn it, k_free or k_held
  double reach = 0;                   // m, from the centre to the point farthest from it
  static constexpr int k_free = 3, k_held = -1;

  /// Whether moments turn the body about an axis in space.
  KOKKOS_INLINE_FUNCTION bool turns_about(int k) const { return axis == k_free || axis == k; }
};

/// How a rigid body resists forces.
template <int Dim>
struct RigidInertia {
  double mass;     // kg
  bool dynamic;    // it moves by the forces on it
  bool held[Dim];  // no force moves it along these axes: a plane of symmetry cuts it, or the user holds it
  Turning<Dim> turning = {};
};

/// Members of a rigid body that the end of a step reads.
template <int Dim>
struct MovingRigid {
  RigidMotion<Dim> motion;
  AngularVector<Dim> momentum = {};  // kg m2/s, angular momentum about the centre of mass
  Wrench<Dim> impulse;               // N s, N m s, of the soil on it since the host last took it
  Wrench<Dim> force;                 // N, N m, external and weight
  RigidInertia<Dim> inertia;

  /// Stores the members that the end of a step changes. MayTurn: as in RigidPose.
  template <bool MayTurn>
  KOKKOS_INLINE_FUNCTION void keep_in(MovingRigid& rigid) const {
    if constexpr (MayTurn) {
      rigid.motion = motion, rigid.momentum = momentum, rigid.impulse = impulse;
    } else {
      rigid.motion.pose.displacement = motion.pose.displacement;
      rigid.motion.velocity = motion.velocity;
      for (int d = 0; d < Dim; ++d) rigid.impulse[Wrench<Dim>::force + d] = impulse[Wrench<Dim>::force + d];
    }
  }
};

}  // namespace mpm
