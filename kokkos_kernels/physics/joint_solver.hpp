#pragma once
// Impulses of joints in a step: those that make their conditions hold at its end, and those that make the
// velocities agree with them.

#include "physics/joint_system.hpp"

namespace mpm {

/// Moves a rigid body from a pose by a step of dt [s], with its momentum as it is.
template <int Dim>
KOKKOS_INLINE_FUNCTION void drift(MovingRigid<Dim>& rigid, const RigidPose<Dim>& from, double dt) {
  RigidMotion<Dim>& motion = rigid.motion;
  motion.pose = from;
  for (int d = 0; d < Dim; ++d) motion.pose.displacement[d] += dt * motion.velocity[d];
  if (!motion.pose.turns) return;
  if (turns_by_moments(rigid) && rigid.inertia.turning.axis == Turning<Dim>::k_free)
    return turn_freely(rigid.inertia.turning, rigid.momentum, dt, motion.pose.rotation);
  AngularVector<Dim> angle;
  for (int k = 0; k < k_turning_axes<Dim>; ++k) angle[k] = dt * motion.spin[k];
  motion.pose.rotation = from.rotation.then(Rotation<Dim>::by(angle));
}

template <int Dim>
struct JointSolver {
  static constexpr double k_closed = 1e-10;  // share of the scale of a row within which its limit is met
  static constexpr double k_failed = 1e-6;   // share beyond which a joint is not closed
  Rigid<Dim>* rigids;
  const LinkedStart<Dim>* starts;
  Joint<Dim>* joints;
  JointRow<Dim>*rows, *rows_after;  // at the places before the movement, or at present; and behind it
  JointSystem<Dim> system;
  double *impulse, *before, *x;  // of each row: N s; its velocity before the impulses, m/s; scratch
  int rigid_count, joint_count;
  double mesh, dt;  // m, of the mesh; s

  /// Moves the bodies by the step so that all joints are closed at its end. Returns the joint that is open at
  /// most, where it cannot be closed, else -1.
  KOKKOS_INLINE_FUNCTION int close() const {
    write(rows, 0);
    begin();
    const int passes = 4 + 2 * system.count;
    for (int pass = 0; pass < passes; ++pass) {
      system.factor();
      iterate();
      if (!change_open()) break;
    }
    book();
    for (int j = 0; j < joint_count; ++j)
      for (int d = 0; d < Dim; ++d) joints[j].way[d] += dt * joints[j].velocity[d];
    int worst = -1;
    double most = k_failed;
    for (int i = 0; i < system.count; ++i)
      if (const double off = excess(rows_after[i]); off > most) most = off, worst = rows[i].joint;
    return worst;
  }

  /// Makes the velocities of the bodies agree with the joints where they are.
  KOKKOS_INLINE_FUNCTION void steady() const {
    write(rows, 0);
    begin();
    const int passes = 4 + 2 * system.count;
    for (int pass = 0; pass < passes; ++pass) {
      system.factor();
      for (int i = 0; i < system.count; ++i) impulse[i] = rows[i].drive - before[i];
      system.solve(impulse);
      if (!change_moving()) break;
    }
    for (int i = 0; i < system.count; ++i) push_along(rows[i], impulse[i], rigids);
    book();
  }

 private:
  /// Writes the rows of all joints. time [s]: by which the ends on the ground have moved.
  KOKKOS_INLINE_FUNCTION void write(JointRow<Dim>* to, double time) const {
    for (int j = 0; j < joint_count; ++j) {
      if (joints[j].rows() == 0) continue;
      Vector<double, Dim> way = joints[j].way;
      for (int d = 0; d < Dim; ++d) way[d] += time * joints[j].velocity[d];
      JointRows<Dim>(joints[j], way, rigids, to, j, mesh).write();
      to += joints[j].rows();
    }
  }
  KOKKOS_INLINE_FUNCTION static bool at_limit(const JointRow<Dim>& row) {
    return !row.one_sided || row.error > -k_closed * row.scale;
  }
  KOKKOS_INLINE_FUNCTION static double excess(const JointRow<Dim>& row) {
    return (row.one_sided ? row.error : Kokkos::fabs(row.error)) / row.scale;
  }
  KOKKOS_INLINE_FUNCTION void begin() const {
    for (int i = 0; i < system.count; ++i) {
      impulse[i] = 0;
      before[i] = velocity_of(rows[i], rigids);
      rows[i].active = at_limit(rows[i]);
    }
  }

  /// Newton's method with the matrix of the places before the movement, until round-off.
  KOKKOS_INLINE_FUNCTION void iterate() const {
    constexpr int k_most = 30;
    constexpr double k_exact = 1e-16;
    double last = Kokkos::Experimental::infinity_v<double>;
    for (int n = 0;; ++n) {
      for (int r = 0; r < rigid_count; ++r) drift(rigids[r], starts[r].pose, dt);
      write(rows_after, dt);
      double most = 0;
      for (int i = 0; i < system.count; ++i)
        if (rows[i].active) most = Kokkos::fmax(most, Kokkos::fabs(rows_after[i].error) / rows[i].scale);
      if (n == k_most || most <= k_exact || !(most < last / 2)) return;
      last = most;
      for (int i = 0; i < system.count; ++i) x[i] = -rows_after[i].error / dt;
      system.solve(x);
      for (int r = 0; r < rigid_count; ++r) rigids[r].motion.pose = starts[r].pose;
      for (int i = 0; i < system.count; ++i) {
        impulse[i] += x[i];
        push_along(rows[i], x[i], rigids);
      }
    }
  }

  /// Lets go of limits that would have to push, and holds those that are passed. Whether there were any.
  KOKKOS_INLINE_FUNCTION bool change_open() const {
    bool any = false;
    for (int r = 0; r < rigid_count; ++r) rigids[r].motion.pose = starts[r].pose;
    for (int i = 0; i < system.count; ++i) {
      if (!rows[i].one_sided) continue;
      const bool pushes = rows[i].active && impulse[i] > 0;
      if (pushes) push_along(rows[i], -impulse[i], rigids), impulse[i] = 0;
      const bool passed = !rows[i].active && excess(rows_after[i]) > k_closed;
      if (pushes || passed) rows[i].active = passed, any = true;
    }
    if (!any)
      for (int r = 0; r < rigid_count; ++r) drift(rigids[r], starts[r].pose, dt);
    return any;
  }

  /// Likewise for velocities: limits that are met may not move on.
  KOKKOS_INLINE_FUNCTION bool change_moving() const {
    constexpr double k_still = 1e-10;  // share of the largest velocity that is round-off
    bool any = false;
    double most = 0;
    for (int i = 0; i < system.count; ++i) {
      if (!rows[i].active) impulse[i] = 0;
      most = Kokkos::fmax(most, Kokkos::fabs(before[i] - rows[i].drive));
    }
    for (int i = 0; i < system.count; ++i) {
      if (!rows[i].one_sided || !at_limit(rows[i])) continue;
      const bool pushes = rows[i].active && impulse[i] > 0;
      const bool goes_on = !rows[i].active && after(i) - rows[i].drive > k_still * most;
      if (pushes || goes_on) rows[i].active = goes_on, any = true;
    }
    return any;
  }

  /// Velocity of row i with all impulses [m/s].
  KOKKOS_INLINE_FUNCTION double after(int i) const {
    double sum = before[i];
    for (int j = 0; j < system.count; ++j)
      if (impulse[j] != 0) sum += system.answer(rows[i], rows[j]) * impulse[j];
    return sum;
  }

  /// Adds the impulses to the reactions of this step, and their work along the ways of ends on the ground.
  KOKKOS_INLINE_FUNCTION void book() const {
    for (int i = 0; i < system.count; ++i) {
      Joint<Dim>& joint = joints[rows[i].joint];
      for (int d = 0; d < Dim; ++d)
        joint.of_step[Wrench<Dim>::force + d] += impulse[i] * rows[i].direction[d];
      for (int k = 0; k < k_turning_axes<Dim>; ++k)
        joint.of_step[Wrench<Dim>::moment + k] += impulse[i] * rows[i].couple[k];
      joint.work += impulse[i] * rows[i].drive;
    }
  }
};

}  // namespace mpm
