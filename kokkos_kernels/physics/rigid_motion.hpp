#pragma once
// Motion of a rigid body in a step.

#include "data/rigid_motion.hpp"
#include "data/rigid_pairs.hpp"
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

/// Turns a body with angular momentum `momentum` [kg m2/s], which stays, by a step of dt [s]: about one
/// principal axis after the other, 1-2-3-2-1, about each exactly (symmetric splitting of the free rigid body,
/// McLachlan 1993).
KOKKOS_INLINE_FUNCTION void turn_freely(const Turning<3>& body, const AngularVector<3>& momentum, double dt,
                                        Rotation<3>& rotation) {
  Rotation<3> place = body.axes.then(rotation);  // of the principal axes
  Vector<double, 3> own = place.turn_back(momentum);
  constexpr int k_order[] = {0, 1, 2, 1, 0};
  for (const int k : k_order) {
    AngularVector<3> angle{};
    angle[k] = (k == 2 ? dt : dt / 2) * own[k] / body.principal[k];
    const Rotation<3> part = Rotation<3>::by(angle);
    own = part.turn_back(own);
    place = part.then(place);
  }
  rotation = body.axes.inverse().then(place);
}
KOKKOS_INLINE_FUNCTION void turn_freely(const Turning<2>& body, const AngularVector<2>& momentum, double dt,
                                        Rotation<2>& rotation) {
  rotation = rotation.then(Rotation<2>::by({dt * momentum[0] / body.principal[0]}));
}

/// Moment of inertia about an axis in space [kg m2].
KOKKOS_INLINE_FUNCTION double inertia_about(const Turning<3>& body, const Rotation<3>& rotation, int axis) {
  Vector<double, 3> along{};
  along[axis] = 1;
  along = body.axes.then(rotation).turn_back(along);
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += body.principal[k] * along[k] * along[k];
  return sum;
}
KOKKOS_INLINE_FUNCTION double inertia_about(const Turning<2>& body, const Rotation<2>&, int) {
  return body.principal[0];
}

/// Angular momentum [kg m2/s] of a body that turns with a spin [rad/s].
KOKKOS_INLINE_FUNCTION AngularVector<3> momentum_of(const Turning<3>& body, const Rotation<3>& rotation,
                                                    const AngularVector<3>& spin) {
  const Rotation<3> place = body.axes.then(rotation);
  Vector<double, 3> own = place.turn_back(spin);
  for (int k = 0; k < 3; ++k) own[k] *= body.principal[k];
  return place.turn(own);
}
KOKKOS_INLINE_FUNCTION AngularVector<2> momentum_of(const Turning<2>& body, const Rotation<2>&,
                                                    const AngularVector<2>& spin) {
  return {body.principal[0] * spin[0]};
}

/// Angular velocity [rad/s] of a body with an angular momentum [kg m2/s].
KOKKOS_INLINE_FUNCTION AngularVector<3> spin_of(const Turning<3>& body, const Rotation<3>& rotation,
                                                const AngularVector<3>& momentum) {
  const Rotation<3> place = body.axes.then(rotation);
  Vector<double, 3> own = place.turn_back(momentum);
  for (int k = 0; k < 3; ++k) own[k] /= body.principal[k];
  return place.turn(own);
}
KOKKOS_INLINE_FUNCTION AngularVector<2> spin_of(const Turning<2>& body, const Rotation<2>&,
                                                const AngularVector<2>& momentum) {
  return {momentum[0] / body.principal[0]};
}

/// Change of the angular momentum of a rigid body in half a step of dt [s] by a moment [N m], less local
/// damping, which brakes it as it brakes forces.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION AngularVector<Dim> kick_of(const MovingRigid<Dim>& rigid, const Wrench<Dim>& contact,
                                                  double damping, double dt) {
  constexpr int spins = k_turning_axes<Dim>, moment = Wrench<Dim>::moment;
  const Turning<Dim>& body = rigid.inertia.turning;
  double scale = 0;  // kg m2, by which local damping compares moments with angular velocities
  for (int k = 0; k < spins; ++k) scale += body.principal[k] / spins;
  AngularVector<Dim> rate{};
  for (int k = 0; k < spins; ++k)
    if (body.turns_about(k)) rate[k] = (rigid.force[moment + k] + contact[moment + k]) / scale;
  const AngularVector<Dim> brake = local_damping<T>(damping, dt, rate, rigid.motion.spin);
  for (int k = 0; k < spins; ++k) rate[k] = dt / 2 * scale * (rate[k] - brake[k]);
  return rate;
}

/// Turns a rigid body by a step of dt [s]; contact: wrench of the soil on it; pairs: what other rigid bodies
/// do to it, null where none is near. Half of the moment's impulse comes before the rotation and half after
/// it. Returns the largest movement by the rotation of a point of
/// the body [m], or a little more.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION double turn_rigid(MovingRigid<Dim>& rigid, const Wrench<Dim>& contact, double damping,
                                         double dt, const PairAction<Dim>* pairs) {
  const Turning<Dim>& body = rigid.inertia.turning;
  RigidMotion<Dim>& motion = rigid.motion;
  Rotation<Dim>& rotation = motion.pose.rotation;
  const AngularVector<Dim> before = motion.spin;
  const bool by_moments = rigid.inertia.dynamic && body.axis != Turning<Dim>::k_held;
  AngularVector<Dim> kick = by_moments ? kick_of<T>(rigid, contact, damping, dt) : AngularVector<Dim>{};
  for (int k = 0; k < k_turning_axes<Dim> && by_moments && pairs != nullptr; ++k)
    if (body.turns_about(k)) kick[k] += dt / 2 * pairs->wrench[Wrench<Dim>::moment + k];
  for (int k = 0; k < k_turning_axes<Dim>; ++k) rigid.momentum[k] += kick[k];
  if (by_moments && body.axis == Turning<Dim>::k_free) {
    turn_freely(body, rigid.momentum, dt, rotation);
    for (int k = 0; k < k_turning_axes<Dim>; ++k) rigid.momentum[k] += kick[k];
    motion.spin = spin_of(body, rotation, rigid.momentum);
  } else {
    AngularVector<Dim> angle;
    const int k = body.axis;
    const double inertia = by_moments ? inertia_about(body, rotation, k) : 1;
    if (by_moments) motion.spin[k] = rigid.momentum[k] / inertia;
    for (int n = 0; n < k_turning_axes<Dim>; ++n) angle[n] = dt * motion.spin[n];
    rotation = rotation.then(Rotation<Dim>::by(angle));
    if (by_moments) rigid.momentum[k] += kick[k], motion.spin[k] = rigid.momentum[k] / inertia;
  }
  double squares = 0, shift = 0;
  if (pairs != nullptr) {
    AngularVector<Dim> angle;
    for (int k = 0; k < k_turning_axes<Dim>; ++k) angle[k] = pairs->shift[Wrench<Dim>::moment + k];
    for (int k = 0; k < k_turning_axes<Dim>; ++k) shift += Kokkos::fabs(angle[k]);
    if (shift > 0) rotation = rotation.then(Rotation<Dim>::by(angle));
  }
  for (int k = 0; k < k_turning_axes<Dim>; ++k) {
    const double w = Kokkos::fmax(Kokkos::fabs(before[k]), Kokkos::fabs(motion.spin[k]));
    squares += w * w;
  }
  return (dt * Kokkos::sqrt(squares) + shift) * body.reach;
}

/// Adds the impulse of a wrench [N, N m] on a body over dt [s] to `impulse`: its moment about the centre, or
/// about a point of the body as it was placed at the start [m], unless that is null.
template <int Dim>
KOKKOS_INLINE_FUNCTION void add_impulse(const RigidPose<Dim>& pose, const Wrench<Dim>& wrench, double dt,
                                        const Vector<double, Dim>* about, Wrench<Dim>& impulse) {
  for (int k = 0; k < wrench_size<Dim>(pose.turns); ++k) impulse[k] += dt * wrench[k];
  if (about == nullptr || !pose.turns) return;
  const Vector<double, Dim> point = pose.to_world(*about);
  const Vector<double, Dim> arm = pose.arm_to([&](int d) { return point[d]; });
  Vector<double, Dim> force;
  for (int d = 0; d < Dim; ++d) force[d] = dt * wrench[Wrench<Dim>::force + d];
  const AngularVector<Dim> moment = moment_of(arm, force);
  for (int k = 0; k < k_turning_axes<Dim>; ++k) impulse[Wrench<Dim>::moment + k] -= moment[k];
}

/// Moves a rigid body by a step of dt [s]; contact [N, N m]: wrench of the soil on it; pairs: what other
/// rigid bodies do to it, which nothing damps, null where none is near. Returns the largest component of the
/// movement of its points [m], or a little more. MayTurn: as in RigidPose.
template <class T, bool MayTurn = true, int Dim>
KOKKOS_INLINE_FUNCTION double advance_rigid(MovingRigid<Dim>& rigid, const Wrench<Dim>& contact,
                                            double damping, double dt,
                                            const PairAction<Dim>* pairs = nullptr) {
  Vector<double, Dim> a = acceleration_of<T>(rigid, contact, damping, dt);
  for (int d = 0; d < Dim && pairs != nullptr; ++d)
    if (rigid.inertia.dynamic && !rigid.inertia.held[d]) a[d] += pairs->wrench[d] / rigid.inertia.mass;
  Vector<double, Dim> way = movement_of(rigid.motion, a, dt);
  for (int d = 0; d < Dim && pairs != nullptr; ++d) way[d] += pairs->shift[d];
  double furthest = 0;
  for (int d = 0; d < Dim; ++d) furthest = Kokkos::fmax(furthest, Kokkos::fabs(way[d]));
  const bool turns = MayTurn && rigid.motion.pose.turns;
  if constexpr (MayTurn)
    if (turns) furthest += turn_rigid<T>(rigid, contact, damping, dt, pairs);
  rigid.motion.pose.move(way);
  for (int k = 0; k < Wrench<Dim>::size; ++k)
    if (k < wrench_size<Dim>(turns)) rigid.impulse[k] += dt * contact[k];
  for (int d = 0; d < Dim; ++d) rigid.motion.velocity[d] += dt * a[d];
  return furthest;
}

}  // namespace mpm
