#pragma once
// The end of a step: the rigid bodies move, the step is counted, and what any point can have moved is added
// to the bound. A team does it.

#include "base/serial_team.hpp"
#include "data/state.hpp"
#include "device/warp.hpp"

namespace mpm {

/// What a step changes of a rigid, and by what.
template <int Dim>
struct MovingRigid {
  RigidPose<Dim> pose;
  Vector<double, Dim> velocity, impulse, force;  // as Rigid has them
  double mass;
  bool dynamic, held[Dim];

  MovingRigid() = default;
  KOKKOS_INLINE_FUNCTION explicit MovingRigid(const Rigid<Dim>& r)
      : pose(r.pose),
        velocity(r.velocity),
        impulse(r.impulse),
        force(r.force),
        mass(r.mass),
        dynamic(r.dynamic) {
    for (int d = 0; d < Dim; ++d) held[d] = r.held[d];
  }

  /// Acceleration [m/s2] under the force [N] of the soil on it (Eq. 7).
  KOKKOS_INLINE_FUNCTION double acceleration(int d, double contact) const {
    return dynamic && !held[d] ? (force[d] + contact) / mass : 0;
  }
  /// Movement in a step [m] with acceleration a, exactly where the force is constant.
  KOKKOS_INLINE_FUNCTION double movement(int d, double a, double dt) const {
    return dt * (velocity[d] + dt / 2 * a);
  }
  /// Moves by a step. contact [N] is the force of the soil. Returns the largest component of its movement
  /// [m].
  KOKKOS_INLINE_FUNCTION double move(const Vector<double, Dim>& contact, double dt) {
    double furthest = 0;
    for (int d = 0; d < Dim; ++d) {
      const double a = acceleration(d, contact[d]), step = movement(d, a, dt);
      furthest = Kokkos::fmax(furthest, Kokkos::fabs(step));
      pose.displacement[d] += step;
      impulse[d] += dt * contact[d];
      velocity[d] += dt * a;
    }
    return furthest;
  }
  KOKKOS_INLINE_FUNCTION void keep_in(Rigid<Dim>& r) const {
    r.pose = pose, r.velocity = velocity, r.impulse = impulse;
  }
};

/// The two as they are at one moment, in the memory that all teams see.
KOKKOS_INLINE_FUNCTION Signal signal_of(const Control& control) {
  return Kokkos::bit_cast<Signal>(load_of_others(reinterpret_cast<const long long*>(&control.ended)));
}

/// Counts the step after `before` and adds what any point can have moved to the bound; moved, margin [cells];
/// late: State::rebuild_late.
template <class T>
KOKKOS_INLINE_FUNCTION void count_step(Control& c, const Control& before, double moved, double margin,
                                       int late) {
  constexpr double epsilon = Kokkos::Experimental::epsilon<T>::value;  // round-off of a coordinate's update
  const double increment = moved + epsilon, bound = before.bound + increment;
  const bool due = late > 0 && rebuild_due(bound, increment, margin, late);
  c.increment = increment, c.bound = bound;
  c.due_in = before.due_in > 0 ? before.due_in - 1 : (due ? late : 0);
  c.steps = before.steps + 1;
  if (before.due_in == 1 || !(bound <= margin) || before.fault_count > 0)
    c.paused = before.paused | Pause::due;
}

template <class Space, class T, int Dim>
struct EndStep {
  using Memory = typename Space::memory_space;
  ControlView<Space> control;
  Movements<Space> movements;
  Kokkos::View<double*, Memory> sums, forces;  // N: of each rigid, and what the slots' nodes leave
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  double dt, spacing, margin;
  int count, slots, late;  // rigids, slots that leave forces
  bool summed;             // the forces are in `sums` already

  EndStep(const State<Space, T, Dim>& s, double step)
      : control(s.control),
        movements(s.movements),
        sums(s.rigid_force),
        forces(s.slot_forces),
        rigids(s.rigids),
        dt(step),
        spacing(s.spacing),
        margin(s.p2g.margin),
        count(static_cast<int>(s.rigid_points.size())),
        slots(s.near_count),
        late(s.rebuild_late),
        summed(s.forces_summed) {}

  static constexpr int warps(int threads) { return (threads + k_warp - 1) / k_warp; }
  /// Doubles that a team of so many threads needs.
  int room(int threads) const { return warps(threads) * (Dim * count + 1); }

  /// part: room(threads)
  template <class Team>
  KOKKOS_INLINE_FUNCTION void operator()(const Team& team, double* part) const {
    const int values = Dim * count, parts = warps(team.team_size()), rank = team.team_rank();
    const Control before = control();  // asked for with all else
    MovingRigid<Dim> rigid{};
    if (rank < count) rigid = MovingRigid<Dim>(rigids(rank));
    const double moved = largest_movement(team);
    if (!summed) sum_forces(team, 0, values, part);
    keep(team, largest_of_warp(moved), part + values * parts);
    team.team_barrier();  // also: no thread looks at `paused` any more
    MPM_ROLLED
    for (int r = rank; r < count; r += team.team_size()) {
      if (r > rank) rigid = MovingRigid<Dim>(rigids(r));
      Vector<double, Dim> contact;
      for (int d = 0; d < Dim; ++d) {
        const int v = r * Dim + d;
        contact[d] = summed ? sums(v) : total(part + v * parts, parts);
        if (!summed) sums(v) = contact[d];
      }
      part[r * Dim * parts] = rigid.move(contact, dt) / spacing;
      rigid.keep_in(rigids(r));
    }
    team.team_barrier();
    once(team, [&] {
      double furthest = 0;  // cells
      MPM_ROLLED
      for (int w = 0; w < parts; ++w) furthest = Kokkos::fmax(furthest, part[values * parts + w]);
      MPM_ROLLED
      for (int r = 0; r < count; ++r) furthest = Kokkos::fmax(furthest, part[r * Dim * parts]);
      count_step<T>(control(), before, furthest, margin, late);
    });
  }

  /// The team of a value sums it. part: room(threads)
  template <class Team>
  KOKKOS_INLINE_FUNCTION void sum(const Team& team, int value, double* part) const {
    sum_forces(team, value, 1, part);
    team.team_barrier();
    once(team, [&] { sums(value) = total(part, warps(team.team_size())); });
  }

  /// Displacement [m] that rigid r will have, to the same bits. Dynamic: it may move by the forces on it,
  /// which are there. part: room(threads).
  template <bool Dynamic, class Team>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> next_displacement(const Team& team, int r, double* part) const {
    const MovingRigid<Dim> rigid(rigids(r));
    Vector<double, Dim> a{}, to = rigid.pose.displacement;
    if constexpr (Dynamic) {
      const int parts = warps(team.team_size());
      team.team_barrier();  // what was there before is done with
      if (rigid.dynamic) sum_forces(team, r * Dim, Dim, part);
      team.team_barrier();
      for (int d = 0; d < Dim && rigid.dynamic; ++d)
        a[d] = rigid.acceleration(d, total(part + d * parts, parts));
    }
    for (int d = 0; d < Dim; ++d) to[d] += rigid.movement(d, a[d], dt);
    return to;
  }

 private:
  template <class Team>
  KOKKOS_INLINE_FUNCTION static void keep(const Team& team, double of_warp, double* part) {
    if (team.team_rank() % k_warp == 0) part[team.team_rank() / k_warp] = of_warp;
  }
  /// Of those noted at the places of a thread [cells], two of which it asks for at once.
  template <class Team>
  KOKKOS_INLINE_FUNCTION double largest_movement(const Team& team) const {
    double moved = 0;
    MPM_ROLLED
    for (int n = team.team_rank(); n < movements.places; n += 2 * team.team_size()) {
      const int m = n + team.team_size();
      const bool two = m < movements.places;
      const double first = movements.noted(n), second = two ? movements.noted(m) : 0.0;
      movements.begin(n);
      if (two) movements.begin(m);
      moved = Kokkos::fmax(moved, Kokkos::fmax(first, second));
    }
    return moved;
  }
  /// Sums of the forces number `first` to first + n by warp, [n][warps], in an order that is always the same.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void sum_forces(const Team& team, int first, int n, double* part) const {
    // Slots and values that a thread asks the memory for at once. On a processor one after the other, so that
    // slots that leave no force change nothing.
    constexpr int k_slots = is_device<Space> ? 4 : 1, k_values = 2;
    const int size = team.team_size(), values = Dim * count;
    MPM_ROLLED
    for (int v = 0; v < n; v += k_values) {
      double sum[k_slots][k_values] = {};
      MPM_ROLLED
      for (int k = team.team_rank(); k < slots; k += k_slots * size)
        for (int m = 0; m < k_slots; ++m)
          for (int w = 0; w < k_values; ++w) {
            const int slot = Kokkos::min(k + m * size, slots - 1), of = Kokkos::min(v + w, n - 1);
            const double value = forces(slot * values + first + of);  // some for nothing, but none waits
            sum[m][w] += slot == k + m * size ? value : 0;
          }
      for (int w = 0; w < k_values; ++w) {
        for (int step = 1; step < k_slots; step *= 2)
          for (int m = 0; m < k_slots; m += 2 * step) sum[m][w] += sum[m + step][w];
        const double all = sum_of_warp(sum[0][w]);
        if (v + w < n) keep(team, all, part + (v + w) * warps(size));
      }
    }
  }
  KOKKOS_INLINE_FUNCTION static double total(const double* part, int parts) {
    double sum = 0;
    MPM_ROLLED
    for (int w = 0; w < parts; ++w) sum += part[w];
    return sum;
  }
};

}  // namespace mpm
