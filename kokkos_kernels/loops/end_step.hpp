#pragma once
// The end of a step: the rigid bodies move, loads that follow tables take their values of the next step, the
// step is counted, and what any point can have moved is added to the bound. A team does it.

#include "base/serial_team.hpp"
#include "data/contact_core.hpp"
#include "data/timed_loads.hpp"
#include "device/warp.hpp"
#include "physics/rigid_motion.hpp"

namespace mpm {

/// Values of Control that the end of a step changes, beside the count of steps.
struct StepEnd {
  double bound, increment;
  int due_in, paused;
  bool fault;  // was met

  KOKKOS_INLINE_FUNCTION explicit StepEnd(const Control& c)
      : bound(c.bound),
        increment(c.increment),
        due_in(c.due_in),
        paused(c.paused),
        fault(c.fault_count != 0) {}

  /// Adds what any point can have moved to the bound; moved, margin [cells], moved infinite where there was a
  /// fault; epsilon: round-off of a coordinate's update [cells]; late: State::rebuild_late.
  KOKKOS_INLINE_FUNCTION void add(double moved, double epsilon, double margin, int late) {
    if (moved < Kokkos::Experimental::infinity_v<double>)
      increment = moved + epsilon;
    else
      fault = true;
    bound += increment;
    const bool due = late > 0 && rebuild_due(bound, increment, margin, late), is_last = due_in == 1;
    due_in = due_in > 0 ? due_in - 1 : (due ? late : 0);
    if (is_last || !(bound <= margin) || fault) paused |= Pause::due;
  }
  KOKKOS_INLINE_FUNCTION void keep_in(Control& c) const {
    c.bound = bound, c.increment = increment, c.due_in = due_in, c.paused = paused;
  }
};

template <class Space, class T, int Dim>
struct EndStep {
  using Memory = typename Space::memory_space;
  ControlView<Space> control;
  Movements<Space> movements;
  Kokkos::View<double*, Memory> sums, forces;  // N: of each rigid, and what the slots' nodes leave
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  NearBodies<Space> near;
  Kokkos::View<PairAction<Dim>*, Memory> pairs;  // on each rigid, where some are near each other
  LoadsOfStep<T, Dim> timed;
  double dt, spacing, margin, damping;
  int count, slots, late;         // rigids, slots that leave forces
  int size;                       // numbers of a wrench in `sums` and `forces`
  int stride;                     // of a slot in `forces`, without lists
  bool summed;                    // the forces are in `sums` already
  const double* moved = nullptr;  // cells, of each rigid, where the rigids have moved already

  EndStep(const ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& loads, double step)
      : control(s.control),
        movements(s.movements),
        sums(s.rigid_force),
        forces(s.contact.forces),
        rigids(s.rigids),
        near(s.contact.near),
        timed(loads.of_step()),
        dt(step),
        spacing(s.spacing),
        margin(s.p2g.margin),
        damping(s.scheme.damping),
        count(static_cast<int>(s.rigid_points.size())),
        slots(s.contact.count),
        late(s.rebuild_late),
        size(wrench_size<Dim>(s.rigid_turns)),
        stride(size * wrenches_of_slot(s)),
        summed(s.forces_summed) {}

  /// Numbers of a wrench, and of the wrenches on all rigids. MayTurn: as in move.
  template <bool MayTurn = true>
  KOKKOS_INLINE_FUNCTION int wrench() const {
    return MayTurn ? size : wrench_size<Dim>(false);
  }
  template <bool MayTurn = true>
  KOKKOS_INLINE_FUNCTION int values() const {
    return wrench<MayTurn>() * count;
  }
  static constexpr int warps(int threads) { return (threads + k_warp - 1) / k_warp; }
  /// Doubles that a team of so many threads needs: of the forces, the warps, and the parts of the forces.
  int room(int threads, int shares = 1) const {
    return values() * (shares > 1 ? 1 + shares : 1) + warps(threads);
  }

  /// Input of the end of a step: the rigids, the forces of the slots' nodes on them, the movements of
  /// particles, and where the forces on the rigids go [N], unless it is null.
  struct Left {
    Rigid<Dim>* rigids;
    const double* forces;
    MovementPlaces<Space> movements;
    double* sums;
  };
  KOKKOS_INLINE_FUNCTION Left left() const {
    return {rigids.data(), forces.data(), movements.of(0), sums.data()};
  }

  /// Does the end of a step. part: room(threads, shares), of which each force is summed in so many shares.
  template <bool MayTurn, int shares, class Team>
  KOKKOS_INLINE_FUNCTION void end(const Team& team, double* part) const {
    const int done = control().steps + 1;
    const StepEnd found = move<MayTurn, shares>(team, StepEnd(control()), left(), true, part, damping);
    set_timed(team, done);
    once(team, [&] {
      found.keep_in(control());
      control().steps = done;
    });
  }

  /// Moves the rigids. found: the end of the step before; clears: the movements begin anew. Returns, to all
  /// threads, the end of this step; until all have it, they need `part`: room(threads). MayTurn: as in
  /// RigidPose; without, all rigids are near all slots, and the code is short. damping [-]: local damping of
  /// the rigids.
  template <bool MayTurn, int shares = 1, class Team>
  KOKKOS_INLINE_FUNCTION StepEnd move(const Team& team, StepEnd found, const Left& left, bool clears,
                                      double* part, double damping) const {
    const int size = wrench<MayTurn>(), values = this->values<MayTurn>();
    const int parts = warps(team.team_size()), rank = team.team_rank();
    MovingRigid<Dim> rigid{};
    if (rank < count) rigid = left.rigids[rank];
    const Noted noted = noted_movements(team, left.movements, clears);
    double most = noted.largest();
    const int here = MayTurn && moved != nullptr ? 0 : count;  // rigids that this team moves
    if constexpr (MayTurn)
      for (int r = rank; r < count - here; r += team.team_size()) most = Kokkos::fmax(most, moved[r]);
    if (!summed) sum_by_warps<MayTurn, shares>(team, left.forces, 0, values, part);
    keep(team, largest_of_warp(most), part + values);
    team.team_barrier();  // also: no thread reads `paused` any more
    MPM_ROLLED
    for (int r = rank; r < here; r += team.team_size()) {
      if (r > rank) rigid = left.rigids[r];
      Wrench<Dim> contact{};
      for (int k = 0; k < Wrench<Dim>::size; ++k) {
        if (k >= size) break;
        const int v = r * size + k;
        contact[k] = summed ? sums(v) : summed_force<MayTurn, shares>(team, part, v);
        if (!summed && left.sums != nullptr) left.sums[v] = contact[k];
      }
      const PairAction<Dim>* action = nullptr;
      if constexpr (MayTurn)  // as in steps one by one
        if (pairs.extent(0) > 0) action = pairs.data() + r;
      part[r * size] = advance_rigid<T, MayTurn>(rigid, contact, damping, dt, action) / spacing;
      rigid.template keep_in<MayTurn>(left.rigids[r]);
    }
    team.team_barrier();
    double furthest = 0;  // cells
    MPM_ROLLED
    for (int w = 0; w < parts; ++w) furthest = Kokkos::fmax(furthest, part[values + w]);
    MPM_ROLLED
    for (int r = 0; r < here; ++r) furthest = Kokkos::fmax(furthest, part[r * size]);
    found.add(furthest, Kokkos::Experimental::epsilon<T>::value, margin, late);
    return found;
  }

  /// Moves rigid r under the force on it, which is in `sums`; returns how far [cells].
  KOKKOS_INLINE_FUNCTION double move_one(int r) const {
    MovingRigid<Dim> rigid = rigids(r);
    Wrench<Dim> contact{};
    for (int k = 0; k < size && k < Wrench<Dim>::size; ++k) contact[k] = sums(r * size + k);
    const PairAction<Dim>* const action = pairs.extent(0) > 0 ? pairs.data() + r : nullptr;
    const double way = advance_rigid<T, true>(rigid, contact, damping, dt, action) / spacing;
    rigid.template keep_in<true>(rigids(r));
    return way;
  }

  /// Sets what follows tables for the step after so many.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void set_timed(const Team& team, int steps) const {
    if (timed.count == 0) return;
    MPM_ROLLED
    for (int n = team.team_rank(); n < timed.count; n += team.team_size())
      timed.set(n, *timed.clock, steps, rigids.data());
    team.team_barrier();
  }

  /// The team of a value sums it. part: room(threads)
  template <class Team>
  KOKKOS_INLINE_FUNCTION void sum(const Team& team, int value, double* part) const {
    keep(team, sum_of_warp(sum_of_thread<true>(forces.data(), value, team.team_rank(), team.team_size())),
         part);
    team.team_barrier();
    once(team, [&] {
      double sum = 0;
      for (int w = 0; w < warps(team.team_size()); ++w) sum += part[w];
      sums(value) = sum;
    });
  }

  /// Pose that rigid r, `of`, will have, to the same bits. Dynamic: it may move by the forces on it, which
  /// are there; no body turns. part: room(threads).
  template <bool Dynamic, class Team>
  KOKKOS_INLINE_FUNCTION RigidPose<Dim> pose_after(const Team& team, int r, const Rigid<Dim>& of,
                                                   double* part) const {
    constexpr int size = wrench_size<Dim>(false);
    const MovingRigid<Dim> rigid = of;
    Vector<double, Dim> a{};
    if constexpr (Dynamic) {
      team.team_barrier();  // what was there before is done with
      if (rigid.inertia.dynamic) sum_by_warps<false, 1>(team, forces.data(), r * size, size, part);
      team.team_barrier();
      Wrench<Dim> contact{};
      for (int k = 0; k < size && rigid.inertia.dynamic; ++k) contact[k] = part[k];
      a = acceleration_of<T>(rigid, contact, damping, dt);
    }
    return next_pose(rigid.motion, a, dt);
  }

 private:
  template <class Team>
  KOKKOS_INLINE_FUNCTION static void keep(const Team& team, double of_warp, double* part) {
    if (team.team_rank() % k_warp == 0) part[team.team_rank() / k_warp] = of_warp;
  }
  /// Movements [cells], of which a thread has asked for the last two without waiting for them.
  struct Noted {
    double most, last[2];
    KOKKOS_INLINE_FUNCTION double largest() const {
      return Kokkos::fmax(most, Kokkos::fmax(last[0], last[1]));
    }
  };
  /// Movements noted at the places of a thread.
  template <class Team>
  KOKKOS_INLINE_FUNCTION static Noted noted_movements(const Team& team,
                                                      const MovementPlaces<Space>& movements, bool clears) {
    Noted noted{};
    MPM_ROLLED
    for (int n = team.team_rank(); n < movements.places; n += 2 * team.team_size()) {
      const int m = n + team.team_size();
      const bool two = m < movements.places;
      noted = {noted.largest(), {movements.noted(n), two ? movements.noted(m) : 0.0}};
      if (clears) movements.begin(n);
      if (clears && two) movements.begin(m);
    }
    return noted;
  }
  /// Place of the parts of the forces.
  template <bool MayTurn, int shares, class Team>
  KOKKOS_INLINE_FUNCTION double* parts_of_forces(const Team& team, double* part) const {
    return shares == 1 ? part : part + values<MayTurn>() + warps(team.team_size());
  }
  /// Sums the forces number `first` to first + n over the slots in so many shares, a warp each: over many
  /// slots one warp would wait for the memory. After a barrier summed_force(v) is force number first + v.
  template <bool MayTurn, int shares, class Team>
  KOKKOS_INLINE_FUNCTION void sum_by_warps(const Team& team, const double* of_slots, int first, int n,
                                           double* part) const {
    const int size = team.team_size(), rank = team.team_rank(), lanes = size < k_warp ? size : k_warp;
    double* const to = parts_of_forces<MayTurn, shares>(team, part);
    MPM_ROLLED
    for (int k = rank / k_warp; k < n * shares; k += warps(size)) {
      const int thread = k % shares * lanes + rank % k_warp;
      const double sum =
          sum_of_warp(sum_of_thread<MayTurn>(of_slots, first + k / shares, thread, shares * lanes));
      if (rank % k_warp == 0) to[k] = sum;
    }
  }
  template <bool MayTurn, int shares, class Team>
  KOKKOS_INLINE_FUNCTION double summed_force(const Team& team, double* part, int v) const {
    const double* const from = parts_of_forces<MayTurn, shares>(team, part) + v * shares;
    double sum = from[0];
    MPM_ROLLED
    for (int k = 1; k < shares; ++k) sum += from[k];
    return sum;
  }
  /// Part of a force that a thread sums, number `rank` of the threads that share the slots, in an order that
  /// is always the same.
  template <bool MayTurn>
  KOKKOS_INLINE_FUNCTION double sum_of_thread(const double* of_slots, int value, int rank,
                                              int threads) const {
    if (!MayTurn || !near.listed) {
      const int stride = MayTurn ? this->stride : values<false>();
      return sum_of_places(slots, rank, threads, [&](int slot) { return of_slots[slot * stride + value]; });
    }
    const int r = value / size, first = near.first(r);
    return sum_of_places(near.first(r + 1) - first, rank, threads,
                         [&](int n) { return of_slots[near.place(first + n) * size + value % size]; });
  }
  /// The same over so many places, each of which leaves force_at(place).
  template <class ForceAt>
  KOKKOS_INLINE_FUNCTION static double sum_of_places(int places, int rank, int threads,
                                                     const ForceAt& force_at) {
    // Places that a thread asks the memory for at once. On a processor one after the other, so that slots
    // that leave no force change nothing.
    constexpr int k_places = is_device<Space> ? 4 : 1;
    double sum[k_places] = {};
    MPM_ROLLED
    for (int k = rank; k < places; k += k_places * threads)
      for (int m = 0; m < k_places; ++m) {
        const int place = Kokkos::min(k + m * threads, places - 1);
        const double force = force_at(place);  // some for nothing, but none waits
        sum[m] += place == k + m * threads ? force : 0;
      }
    for (int step = 1; step < k_places; step *= 2)
      for (int m = 0; m < k_places; m += 2 * step) sum[m] += sum[m + step];
    return sum[0];
  }
};

}  // namespace mpm
