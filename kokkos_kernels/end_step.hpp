#pragma once
// The end of a step: the rigid bodies move, the step is counted, and what any point can have moved is added
// to the bound. A team does it.

#include "state.hpp"
#include "warp.hpp"

namespace mpm {

/// Acceleration of a rigid [m/s2] under the force [N] of the soil on it (Eq. 7).
template <int Dim>
KOKKOS_INLINE_FUNCTION double acceleration(const Rigid<Dim>& rigid, int d, double contact) {
  return rigid.dynamic ? (rigid.force[d] + contact) / rigid.mass : 0;
}
/// Its movement in a step [m] with acceleration a, exactly where the force is constant.
template <int Dim>
KOKKOS_INLINE_FUNCTION double movement(const Rigid<Dim>& rigid, int d, double a, double dt) {
  return dt * (rigid.velocity[d] + dt / 2 * a);
}

/// Moves a rigid by a step. contact [N] is the force of the soil on it. Returns the largest component of its
/// movement [m].
template <int Dim>
KOKKOS_INLINE_FUNCTION double move_rigid(Rigid<Dim>& rigid, const double* contact, double dt) {
  double furthest = 0;
  MPM_ROLLED
  for (int d = 0; d < Dim; ++d) {
    const double a = acceleration(rigid, d, contact[d]), step = movement(rigid, d, a, dt);
    furthest = Kokkos::fmax(furthest, Kokkos::fabs(step));
    rigid.displacement[d] += step;
    rigid.impulse[d] += dt * contact[d];
    rigid.velocity[d] += dt * a;
  }
  return furthest;
}

/// The two as they are at one moment, in the memory that all teams see.
KOKKOS_INLINE_FUNCTION Signal signal_of(const Control& control) {
  return Kokkos::bit_cast<Signal>(load_of_others(reinterpret_cast<const long long*>(&control.ended)));
}

/// Counts the step and adds what any point can have moved to the bound; moved, margin [cells]; late:
/// State::rebuild_late.
template <class T>
KOKKOS_INLINE_FUNCTION void count_step(Control& c, double moved, double margin, int late) {
  constexpr double epsilon = Kokkos::Experimental::epsilon<T>::value;  // round-off of a coordinate's update
  c.increment = moved + epsilon;
  c.bound += c.increment;
  ++c.steps;
  const bool now = c.due_in == 1;
  if (c.due_in > 0)
    --c.due_in;
  else if (late > 0 && rebuild_due(c.bound, c.increment, margin, late))
    c.due_in = late;
  if (now || !(c.bound <= margin) || load_of_others(&c.fault_count) > 0) c.paused |= Pause::due;
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
        sums(s.sums),
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
    const int values = Dim * count, parts = warps(team.team_size());
    if (!summed) sum_forces(team, 0, values, part);
    double moved = 0;  // cells
    MPM_ROLLED
    for (int n = team.team_rank(); n < movements.places; n += team.team_size())
      moved = Kokkos::fmax(moved, movements.take(n));
    keep(team, largest_of_warp(moved), part + values * parts);
    team.team_barrier();  // also: no thread looks at `paused` any more
    MPM_ROLLED
    for (int r = team.team_rank(); r < count; r += team.team_size()) {
      MPM_ROLLED
      for (int v = r * Dim; v < (r + 1) * Dim && !summed; ++v) sums(v) = total(part + v * parts, parts);
      part[r * Dim * parts] = move_rigid(rigids(r), &sums(r * Dim), dt) / spacing;
    }
    team.team_barrier();
    Kokkos::single(Kokkos::PerTeam(team), [&] {
      moved = 0;
      MPM_ROLLED
      for (int w = 0; w < parts; ++w) moved = Kokkos::fmax(moved, part[values * parts + w]);
      MPM_ROLLED
      for (int r = 0; r < count; ++r) moved = Kokkos::fmax(moved, part[r * Dim * parts]);
      count_step<T>(control(), moved, margin, late);
    });
  }

  /// The team of a value sums it. part: room(threads)
  template <class Team>
  KOKKOS_INLINE_FUNCTION void sum(const Team& team, int value, double* part) const {
    sum_forces(team, value, 1, part);
    team.team_barrier();
    Kokkos::single(Kokkos::PerTeam(team), [&] { sums(value) = total(part, warps(team.team_size())); });
  }

  /// Displacement [m] that rigid r will have, to the same bits. Dynamic: it may move by the forces on it,
  /// which are there. part: room(threads).
  template <bool Dynamic, class Team>
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> next_displacement(const Team& team, int r, double* part) const {
    const Rigid<Dim>& rigid = rigids(r);
    Vector<double, Dim> a{}, to;
    if constexpr (Dynamic) {
      const int parts = warps(team.team_size());
      team.team_barrier();  // what was there before is done with
      if (rigid.dynamic) sum_forces(team, r * Dim, Dim, part);
      team.team_barrier();
      for (int d = 0; d < Dim && rigid.dynamic; ++d)
        a[d] = acceleration(rigid, d, total(part + d * parts, parts));
    }
    for (int d = 0; d < Dim; ++d) to[d] = rigid.displacement[d] + movement(rigid, d, a[d], dt);
    return to;
  }

 private:
  template <class Team>
  KOKKOS_INLINE_FUNCTION static void keep(const Team& team, double of_warp, double* part) {
    if (team.team_rank() % k_warp == 0) part[team.team_rank() / k_warp] = of_warp;
  }
  KOKKOS_INLINE_FUNCTION double force(int n) const { return load_of_others(&forces(n)); }
  /// Sums of the forces number `first` to first + n by warp, [n][warps], in an order that is always the same.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void sum_forces(const Team& team, int first, int n, double* part) const {
    constexpr int at_once = 4;  // that a thread asks the memory for
    const int size = team.team_size();
    MPM_ROLLED
    for (int v = first; v < first + n; ++v) {
      double sum[at_once] = {};
      int k = team.team_rank();
      MPM_ROLLED
      for (; k + (at_once - 1) * size < slots; k += at_once * size)
        for (int m = 0; m < at_once; ++m) sum[m] += force((k + m * size) * Dim * count + v);
      MPM_ROLLED
      for (; k < slots; k += size) sum[0] += force(k * Dim * count + v);
      keep(team, sum_of_warp((sum[0] + sum[1]) + (sum[2] + sum[3])), part + (v - first) * warps(size));
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
