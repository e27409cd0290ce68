#pragma once
// Springs and dashpots that hold a rigid body about its place at the start.

#include "data/rigid_links.hpp"
#include "physics/joint_rows.hpp"

namespace mpm {

/// Moment [N m] of springs of angular stiffness [N m/rad] about the axes of space, of the energy 1/2 sum
/// k_i a_i^2 of the rotation vector a: -J^T k a, J the derivative of the rotation vector by the angle in
/// space (Bullo & Murray 1995).
KOKKOS_INLINE_FUNCTION AngularVector<3> moment_of_springs(const AngularVector<3>& stiffness,
                                                          const Rotation<3>& rotation) {
  const AngularVector<3> a = rotation.way_from({});
  const AngularVector<3> f{stiffness[0] * a[0], stiffness[1] * a[1], stiffness[2] * a[2]};
  const AngularVector<3> once = cross(a, f), twice = cross(a, once);
  const double square = dot(a, a), angle = Kokkos::sqrt(square), half = angle / 2;
  const double share =
      angle > 1e-3 ? (1 - half * Kokkos::cos(half) / Kokkos::sin(half)) / square : 1.0 / 12 + square / 720;
  AngularVector<3> moment;
  for (int k = 0; k < 3; ++k) moment[k] = -(f[k] + once[k] / 2 + share * twice[k]);
  return moment;
}
KOKKOS_INLINE_FUNCTION AngularVector<2> moment_of_springs(const AngularVector<2>& stiffness,
                                                          const Rotation<2>& rotation) {
  return {-stiffness[0] * rotation.way_from({})[0]};
}

/// Acts on a rigid body with its springs and dashpots over half a step of dt [s]. after: it is the second
/// half, whose dashpots take the velocity at its end, so that the two halves are symmetric in time.
template <int Dim>
KOKKOS_INLINE_FUNCTION void push_by_support(RigidSupport<Dim>& support, MovingRigid<Dim>& rigid, double dt,
                                            bool after) {
  if (!support.on || !rigid.inertia.dynamic) return;
  constexpr int force = Wrench<Dim>::force, moment = Wrench<Dim>::moment, spins = k_turning_axes<Dim>;
  const double half = dt / 2;
  Vector<double, Dim> impulse;
  for (int d = 0; d < Dim; ++d) {
    const double c = half * support.viscosity[force + d];
    impulse[d] = -half * support.stiffness[force + d] * rigid.motion.pose.displacement[d];
    const double v = rigid.motion.velocity[d], m = rigid.inertia.mass;
    impulse[d] -= c * (after ? (v + impulse[d] / m) / (1 + c / m) : v);
    if (rigid.inertia.held[d]) impulse[d] = 0;
  }
  AngularVector<Dim> turn{}, stiffness;
  if (turns_by_moments(rigid)) {
    for (int k = 0; k < spins; ++k) stiffness[k] = support.stiffness[moment + k];
    const AngularVector<Dim> spring = moment_of_springs(stiffness, rigid.motion.pose.rotation);
    AngularVector<Dim> spin = rigid.motion.spin;
    constexpr int k_repeats = 6;  // of a linear equation for the spin at the end, to beyond its order in time
    for (int n = 0; n < (after ? k_repeats : 1); ++n) {
      AngularVector<Dim> momentum = rigid.momentum;
      for (int k = 0; k < spins; ++k) {
        turn[k] = rigid.inertia.turning.turns_about(k)
                      ? half * (spring[k] - support.viscosity[moment + k] * spin[k])
                      : 0;
        momentum[k] += turn[k];
      }
      if (after) spin = spin_by(rigid, momentum);
    }
  }
  push(rigid, impulse, turn);
  for (int d = 0; d < Dim; ++d) support.impulse[force + d] += impulse[d];
  for (int k = 0; k < spins; ++k) support.impulse[moment + k] += turn[k];
}

}  // namespace mpm
