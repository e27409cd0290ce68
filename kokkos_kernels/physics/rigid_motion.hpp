#pragma once
// Motion of a rigid body in a step.

#include "data/rigid_motion.hpp"
#include "physics/local_damping.hpp"

namespace mpm {

/// Acceleration [m/s2] of a rigid body in a step of dt [s] under the wrench [N] of the soil on it (Eq. 7),
/// less local damping as at a node. T: precision of the soil's forces.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Vector<double, Dim> acceleration_of(const MovingRigid<Dim>& rigid,
                                                           const Wrench<Dim>& contact, double damping,
                                                           double dt) {
  constexpr int force = Wrench<Dim>::force;
  Vector<double, Dim> a{};
  for (int d = 0; d < Dim; ++d)
    a[d] = rigid.inertia.dynamic && !rigid.inertia.held[d]
               ? (rigid.force[force + d] + contact[force + d]) / rigid.inertia.mass
               : 0;
  const Vector<double, Dim> brake = local_damping<T>(damping, dt, a, rigid.motion.velocity);
  for (int d = 0; d < Dim; ++d) a[d] -= brake[d];
  return a;
}

/// Movement [m] in a step of dt [s] with acceleration a [m/s2], exactly where the force is constant. A
/// processor calls it, so that no caller rounds the movement and the new place at once.
template <int Dim>
MPM_SELDOM_FUNCTION Vector<double, Dim> movement_of(const RigidMotion<Dim>& motion,
                                                    const Vector<double, Dim>& a, double dt) {
  Vector<double, Dim> way;
  for (int d = 0; d < Dim; ++d) way[d] = dt * (motion.velocity[d] + dt / 2 * a[d]);
  return way;
}

/// Pose after a step of dt [s] with acceleration a [m/s2], to the bits of advance_rigid.
template <int Dim>
KOKKOS_INLINE_FUNCTION RigidPose<Dim> next_pose(const RigidMotion<Dim>& motion, const Vector<double, Dim>& a,
                                                double dt) {
  RigidPose<Dim> pose = motion.pose;
  pose.move(movement_of(motion, a, dt));
  return pose;
}

/// Moves a rigid body by a step of dt [s]; contact [N]: wrench of the soil on it. Returns the largest
/// component of the movement of its points [m].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION double advance_rigid(MovingRigid<Dim>& rigid, const Wrench<Dim>& contact,
                                            double damping, double dt) {
  const Vector<double, Dim> a = acceleration_of<T>(rigid, contact, damping, dt),
                            way = movement_of(rigid.motion, a, dt);
  double furthest = 0;
  for (int d = 0; d < Dim; ++d) furthest = Kokkos::fmax(furthest, Kokkos::fabs(way[d]));
  rigid.motion.pose.move(way);
  for (int k = 0; k < Wrench<Dim>::size; ++k) rigid.impulse[k] += dt * contact[k];
  for (int d = 0; d < Dim; ++d) rigid.motion.velocity[d] += dt * a[d];
  return furthest;
}

}  // namespace mpm
