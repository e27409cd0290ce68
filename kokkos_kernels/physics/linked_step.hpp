#pragma once
// A step of rigid bodies that joints, springs or dashpots link.

#include "data/rigid_pairs.hpp"
#include "physics/joint_solver.hpp"
#include "physics/rigid_support.hpp"

namespace mpm {

/// A step of all rigid bodies of a run, symmetric in time: half of the forces' impulse, the movement, the
/// other half. Impulses of the joints before the movement close them at its end, and impulses behind the
/// second half make the velocities agree with them (RATTLE, Andersen 1983), so that energy does not drift.
/// One thread does it. T: precision of the soil's forces.
template <class T, int Dim>
struct LinkedStep {
  static constexpr int spins = k_turning_axes<Dim>;
  JointSolver<Dim> solver;
  RigidSupport<Dim>* supports;
  LinkedStart<Dim>* starts;
  const double* contact;         // N, N m, of the soil on each rigid
  int size;                      // numbers of a wrench there
  const PairAction<Dim>* pairs;  // of other rigid bodies on each; null where none is near
  double damping;

  /// Moves the rigids. Returns a joint that cannot be closed, else -1.
  KOKKOS_INLINE_FUNCTION int operator()() const {
    for (int r = 0; r < solver.rigid_count; ++r) begin(r);
    const int open = solver.close();
    for (int r = 0; r < solver.rigid_count; ++r) end(r);
    solver.steady();
    for (int j = 0; j < solver.joint_count; ++j) book(solver.joints[j]);
    return open;
  }

  /// Largest component of the movement of a point of a rigid in this step [m], or a little more.
  KOKKOS_INLINE_FUNCTION double moved(int r) const {
    const RigidPose<Dim>&before = starts[r].pose, &now = solver.rigids[r].motion.pose;
    double way = 0, square = 0;
    for (int d = 0; d < Dim; ++d)
      way = Kokkos::fmax(way, Kokkos::fabs(now.displacement[d] - before.displacement[d]));
    if (!now.turns) return way;
    const AngularVector<Dim> angle = now.rotation.way_from(before.rotation);
    for (int k = 0; k < spins; ++k) square += angle[k] * angle[k];
    return way + Kokkos::sqrt(square) * solver.rigids[r].inertia.turning.reach;
  }

 private:
  KOKKOS_INLINE_FUNCTION void begin(int r) const {
    MovingRigid<Dim>& rigid = solver.rigids[r];
    LinkedStart<Dim>& start = starts[r];
    Wrench<Dim> soil{};
    for (int k = 0; k < size; ++k) soil[k] = contact[r * size + k];
    start.pose = rigid.motion.pose;
    const Vector<double, Dim> a = acceleration_of<T>(rigid, soil, damping, solver.dt);
    for (int d = 0; d < Dim; ++d) start.kick[d] = solver.dt / 2 * a[d];
    start.turn = turns_by_moments(rigid) ? kick_of<T>(rigid, soil, damping, solver.dt) : AngularVector<Dim>{};
    if (pairs != nullptr) add_pairs(pairs[r], rigid, start);
    add_soil_impulse(r, soil);
    push_by_support(supports[r], rigid, solver.dt, false);
    kick(rigid, start);
  }
  /// Adds what other rigid bodies do to one, as advance_rigid does.
  KOKKOS_INLINE_FUNCTION void add_pairs(const PairAction<Dim>& by, MovingRigid<Dim>& rigid,
                                        LinkedStart<Dim>& start) const {
    Vector<double, Dim> way{};
    AngularVector<Dim> angle{};
    for (int d = 0; d < Dim; ++d) {
      if (!rigid.inertia.dynamic || rigid.inertia.held[d]) continue;
      start.kick[d] += solver.dt / 2 * by.wrench[d] / rigid.inertia.mass;
      way[d] = by.shift[d];
    }
    rigid.motion.pose.move(way);
    if (!turns_by_moments(rigid)) return;
    for (int k = 0; k < spins; ++k) {
      angle[k] = by.shift[Wrench<Dim>::moment + k];
      if (rigid.inertia.turning.turns_about(k))
        start.turn[k] += solver.dt / 2 * by.wrench[Wrench<Dim>::moment + k];
    }
    rigid.motion.pose.rotation = rigid.motion.pose.rotation.then(Rotation<Dim>::by(angle));
  }
  KOKKOS_INLINE_FUNCTION void end(int r) const {
    MovingRigid<Dim>& rigid = solver.rigids[r];
    kick(rigid, starts[r]);
    push_by_support(supports[r], rigid, solver.dt, true);
  }
  KOKKOS_INLINE_FUNCTION static void kick(MovingRigid<Dim>& rigid, const LinkedStart<Dim>& by) {
    for (int d = 0; d < Dim; ++d) rigid.motion.velocity[d] += by.kick[d];
    if (!turns_by_moments(rigid)) return;
    for (int k = 0; k < spins; ++k) rigid.momentum[k] += by.turn[k];
    rigid.motion.spin = spin_by(rigid, rigid.momentum);
  }
  /// Adds the impulse of the soil on a rigid to that since the host last took it.
  KOKKOS_INLINE_FUNCTION void add_soil_impulse(int r, const Wrench<Dim>& soil) const {
    MovingRigid<Dim>& rigid = solver.rigids[r];
    add_impulse(rigid.motion.pose, soil, solver.dt, supports[r].has_point ? &supports[r].point : nullptr,
                rigid.impulse);
  }
  /// Adds the reaction of this step to that since the host last took it.
  KOKKOS_INLINE_FUNCTION void book(Joint<Dim>& joint) const {
    double square = 0;
    for (int d = 0; d < Dim; ++d) {
      const double force = joint.of_step[Wrench<Dim>::force + d] / solver.dt;
      square += force * force;
    }
    joint.peak = Kokkos::fmax(joint.peak, Kokkos::sqrt(square));
    for (int k = 0; k < Wrench<Dim>::size; ++k) joint.impulse[k] += joint.of_step[k], joint.of_step[k] = 0;
  }
};

}  // namespace mpm
