#pragma once
// Conditions of joints between rigid bodies, as rows of a linear system of their impulses.

#include "data/rigid.hpp"
#include "data/rigid_links.hpp"
#include "physics/rigid_motion.hpp"

namespace mpm {

/// Whether forces move a rigid body at all.
template <int Dim>
KOKKOS_INLINE_FUNCTION bool turns_by_moments(const MovingRigid<Dim>& rigid) {
  return rigid.inertia.dynamic && rigid.motion.pose.turns &&
         rigid.inertia.turning.axis != Turning<Dim>::k_held;
}

/// Velocity that an impulse [N s] gives a rigid body [m/s].
template <int Dim>
KOKKOS_INLINE_FUNCTION Vector<double, Dim> velocity_by(const MovingRigid<Dim>& rigid,
                                                       const Vector<double, Dim>& impulse) {
  Vector<double, Dim> v{};
  for (int d = 0; d < Dim; ++d)
    if (rigid.inertia.dynamic && !rigid.inertia.held[d]) v[d] = impulse[d] / rigid.inertia.mass;
  return v;
}

/// Angular velocity [rad/s] of a rigid body with an angular momentum [kg m2/s], or by a moment's impulse.
template <int Dim>
KOKKOS_INLINE_FUNCTION AngularVector<Dim> spin_by(const MovingRigid<Dim>& rigid,
                                                  const AngularVector<Dim>& momentum) {
  const Turning<Dim>& body = rigid.inertia.turning;
  const Rotation<Dim>& rotation = rigid.motion.pose.rotation;
  AngularVector<Dim> spin{};
  if (!turns_by_moments(rigid)) return spin;
  if (body.axis == Turning<Dim>::k_free) return spin_of(body, rotation, momentum);
  spin[body.axis] = momentum[body.axis] / inertia_about(body, rotation, body.axis);
  return spin;
}

/// Adds an impulse [N s] and its moment [N m s] about the centre of mass to the motion of a rigid body.
template <int Dim>
KOKKOS_INLINE_FUNCTION void push(MovingRigid<Dim>& rigid, const Vector<double, Dim>& impulse,
                                 const AngularVector<Dim>& moment) {
  const Vector<double, Dim> v = velocity_by(rigid, impulse);
  for (int d = 0; d < Dim; ++d) rigid.motion.velocity[d] += v[d];
  if (!turns_by_moments(rigid)) return;
  for (int k = 0; k < k_turning_axes<Dim>; ++k)
    if (rigid.inertia.turning.turns_about(k)) rigid.momentum[k] += moment[k];
  rigid.motion.spin = spin_by(rigid, rigid.momentum);
}

/// Writes the rows of a joint for the present places of its bodies.
template <int Dim>
struct JointRows {
  static constexpr int spins = k_turning_axes<Dim>;
  const Joint<Dim>& joint;
  const Rigid<Dim>* rigids;
  JointRow<Dim>* row;
  int number;                          // of the joint
  double size;                         // m, of the mesh
  Vector<double, Dim> end[2], arm[2];  // m, of the first end on the bodies

  /// way [m]: of the end on the ground.
  KOKKOS_INLINE_FUNCTION JointRows(const Joint<Dim>& of, const Vector<double, Dim>& way,
                                   const Rigid<Dim>* all, JointRow<Dim>* rows, int n, double mesh)
      : joint(of), rigids(all), row(rows), number(n), size(mesh) {
    for (int side = 0; side < 2; ++side) {
      end[side] = has_body(side) ? pose(side).to_world(joint.end[side]) : joint.end[side];
      for (int d = 0; d < Dim && !has_body(side); ++d) end[side][d] += way[d];
    }
  }

  KOKKOS_INLINE_FUNCTION void write() {
    const bool at_first = joint.slides;  // the force of a slider acts at the first end, wherever that is
    for (int side = 0; side < 2; ++side) arm[side] = arm_to(side, end[at_first ? 0 : side]);
    if (joint.holds_point) hold_point();
    if (joint.slides) hold_across();
    if (joint.holds_length) hold_length();
    if (joint.held_turn == HeldTurn::all) hold_turns();
    if constexpr (Dim == 3)
      if (joint.held_turn == HeldTurn::about_others) hold_axis();
    if (joint.stops) hold_stops();
  }

 private:
  KOKKOS_INLINE_FUNCTION bool has_body(int side) const { return joint.body[side] != Joint<Dim>::k_ground; }
  KOKKOS_INLINE_FUNCTION const RigidPose<Dim>& pose(int side) const {
    return rigids[joint.body[side]].motion.pose;
  }
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> arm_to(int side, const Vector<double, Dim>& place) const {
    return has_body(side) ? pose(side).arm_to([&](int d) { return place[d]; }) : Vector<double, Dim>{};
  }
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> turned(int side, const Vector<double, Dim>& v) const {
    return has_body(side) ? pose(side).turn_to_world(v) : v;
  }
  KOKKOS_INLINE_FUNCTION Rotation<Dim> rotation(int side) const {
    return has_body(side) && pose(side).turns ? pose(side).rotation : Rotation<Dim>{};
  }

  /// Puts a row: a force along a direction at the ends, where `forces`, else a couple.
  KOKKOS_INLINE_FUNCTION void put(bool forces, const Vector<double, Dim>& direction,
                                  const AngularVector<Dim>& couple, double error, bool one_sided) {
    JointRow<Dim>& to = *row++;
    to = JointRow<Dim>{};
    to.joint = number, to.error = error, to.one_sided = one_sided;
    to.direction = direction, to.couple = couple;
    to.scale = forces ? size : 1;
    for (int d = 0; d < Dim && !has_body(1); ++d) to.drive += joint.velocity[d] * direction[d];
    for (int side = 0; side < 2; ++side) {
      to.body[side] = joint.body[side];
      if (!has_body(side)) continue;
      const Rigid<Dim>& rigid = rigids[joint.body[side]];
      to.moment[side] = forces ? moment_of(arm[side], direction) : couple;
      to.velocity[side] = velocity_by(rigid, direction);
      to.spin[side] = spin_by(rigid, to.moment[side]);
    }
  }
  KOKKOS_INLINE_FUNCTION void put_force(const Vector<double, Dim>& direction, double error,
                                        bool one_sided = false) {
    put(true, direction, {}, error, one_sided);
  }
  KOKKOS_INLINE_FUNCTION void put_couple(const AngularVector<Dim>& couple, double error,
                                         bool one_sided = false) {
    put(false, {}, couple, error, one_sided);
  }

  KOKKOS_INLINE_FUNCTION void hold_point() {
    for (int d = 0; d < Dim; ++d) {
      Vector<double, Dim> along{};
      along[d] = 1;
      put_force(along, end[0][d] - end[1][d]);
    }
  }
  KOKKOS_INLINE_FUNCTION void hold_across() {
    for (int k = 1; k < Dim; ++k) {
      const Vector<double, Dim> across = turned(1, joint.axes[k]);
      double error = 0;
      for (int d = 0; d < Dim; ++d) error += across[d] * (end[0][d] - end[1][d]);
      put_force(across, error);
    }
  }
  KOKKOS_INLINE_FUNCTION void hold_length() {
    Vector<double, Dim> along;
    for (int d = 0; d < Dim; ++d) along[d] = end[0][d] - end[1][d];
    const double length = Kokkos::sqrt(dot(along, along));
    for (int d = 0; d < Dim; ++d) along[d] = length > 0 ? along[d] / length : double(d == 0);
    put_force(along, length - joint.length, joint.pulls_only);
  }
  KOKKOS_INLINE_FUNCTION void hold_turns() {
    const AngularVector<Dim> off = rotation(0).way_from(rotation(1));
    for (int k = 0; k < spins; ++k) {
      AngularVector<Dim> about{};
      about[k] = 1;
      put_couple(about, off[k]);
    }
  }
  /// The axis of the first body stays normal to the two directions across that of the second.
  KOKKOS_INLINE_FUNCTION void hold_axis() {
    const Vector<double, Dim> axis = turned(0, joint.axes[0]);
    for (int k = 1; k < Dim; ++k) {
      const Vector<double, Dim> across = turned(1, joint.axes[k]);
      put_couple(moment_of(axis, across), dot(axis, across));
    }
  }
  /// Angle of the first body against the second about the axis [rad]; in 3D within half a turn.
  KOKKOS_INLINE_FUNCTION double angle() const {
    if constexpr (Dim == 2) {
      return rotation(0).way_from(rotation(1))[0];
    } else {
      const Vector<double, Dim> of_first = turned(0, joint.axes[1]);
      return Kokkos::atan2(dot(of_first, turned(1, joint.axes[2])), dot(of_first, turned(1, joint.axes[1])));
    }
  }
  /// The stop that is nearer.
  KOKKOS_INLINE_FUNCTION void hold_stops() {
    const double now = angle();
    const bool upper = now > (joint.stop[0] + joint.stop[1]) / 2;
    const double sign = upper ? 1 : -1;
    AngularVector<Dim> about{};
    if constexpr (Dim == 2) {
      about[0] = sign;
    } else {
      about = turned(1, joint.axes[0]);
      for (int k = 0; k < Dim; ++k) about[k] *= sign;
    }
    put_couple(about, upper ? now - joint.stop[1] : joint.stop[0] - now, true);
  }
};

}  // namespace mpm
