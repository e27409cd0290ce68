#pragma once
// Contact between rigid bodies in a step: the contacts of each pair, and the impulses of all of them.

#include "base/serial_team.hpp"
#include "data/contact_core.hpp"
#include "device/warp.hpp"
#include "physics/pair_contact.hpp"

namespace mpm {

/// Parts of the solution of a step. A team of one warp finds the contacts of a pair. One team solves for the
/// impulses: pair by pair (projected Gauss-Seidel), those of one colour at once, since no two of them move
/// the same body; so the result does not depend on the number of threads.
template <class Space, class T, int Dim>
struct PairSolution {
  using Memory = typename Space::memory_space;
  static constexpr int k_ways = k_pair_ways<Dim>, k_most = k_pair_contacts<Dim>;
  ControlView<Space> control;
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  Kokkos::View<double*, Memory> forces;  // N, of the soil on the rigids
  PairViews<Space, Dim> pairs;
  double dt, damping, spacing, room;  // s, -, m, m: more than any coordinate in the mesh
  int count, size;                    // rigids; numbers of a wrench in `forces`

  PairSolution(const ContactCore<Space, T, Dim>& s, double step)
      : control(s.control),
        rigids(s.rigids),
        forces(s.rigid_force),
        pairs(s.pairs),
        dt(step),
        damping(s.scheme.damping),
        spacing(s.spacing),
        room(0),
        count(static_cast<int>(s.rigid_points.size())),
        size(wrench_size<Dim>(s.rigid_turns)) {
    for (int d = 0; d < Dim; ++d) room += 2 * s.spacing * s.grid.cells[d];
  }

  /// Sets the motion of a body without contact between rigid bodies.
  KOKKOS_INLINE_FUNCTION void begin(int n) const {
    PairMotion<Dim> motion{};
    if (n < count) {
      Wrench<Dim> soil{};
      for (int k = 0; k < size; ++k) soil[k] = forces(n * size + k);
      motion = free_motion<T>(rigids(n), soil, damping, dt);
    }
    pairs.motions(n) = motion;
  }

  /// Finds the contacts of pair number m: the places farthest along some ways, of those that touch in the
  /// step. A place that stays away from the other body counts as less far, since it would hide one that
  /// touches.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void find(const Team& team, int m) const {
    constexpr double k_steep = 100;  // way that a gap is worth at the end of the step, over the gap
    const RigidPair pair = pairs.list(m);
    const PairPlaces<Dim> places{pairs.bodies(pair.a), pairs.bodies(pair.b),
                                 pose_of(rigids.data(), count, pair.a),
                                 pose_of(rigids.data(), count, pair.b)};
    const double most = slack(places.a, pairs.motions(pair.a)) + slack(places.b, pairs.motions(pair.b));
    double best[k_most] = {};
    int which[k_most];
    for (int k = 0; k < k_most; ++k) which[k] = -1;
    MPM_ROLLED
    for (int n = places.begin() + team.team_rank(); n < places.end(); n += team.team_size()) {
      const Nearness<Dim> at = places(n, pairs.points, pairs.vertices);
      if (!(at.gap < most)) continue;
      const double spread =
          2 * room - Kokkos::fmin(room, k_steep * Kokkos::fmax(0.0, ahead(pair, places, at)));
      for (int k = 0; k < k_most; ++k) {
        double score = k < k_ways ? spread : most - at.gap;
        for (int d = 0; d < Dim && k < k_ways; ++d) score += pair_way<Dim>(k, d) * at.place[d];
        if (score > best[k]) best[k] = score, which[k] = n;
      }
    }
    for (int k = 0; k < k_most; ++k) which[k] = farthest(best[k], which[k]);
    if (team.team_rank() == 0) keep(m, pair, places, which);
  }

  /// Solves for the impulses. part: as many doubles as the team has warps. MPM_ROLLED keeps it short.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void solve(const Team& team, double* part) const {
    constexpr int k_shifts = 10, k_softer = 8;
    constexpr double k_share = 0.01, k_step = 0.01;  // of a shift; cells
    const double most = k_step * spacing, speed = largest(team, fastest(team), part);
    relax(team, part, speed);
    MPM_ROLLED
    for (int n = 1; n <= k_softer; ++n) {
      if (!(sweep(team, part, [&](const RigidPair& pair, PairContact<Dim>& at) {
              return soften_impact(at, pairs.motions(pair.a), pairs.motions(pair.b), pair.friction,
                                   n == k_softer);
            }) > 0))
        break;
      relax(team, part, speed);
    }
    double change = 0, first = 0;
    MPM_ROLLED
    for (int n = 0; n < k_shifts; ++n) {
      change = sweep(team, part, [&](const RigidPair& pair, PairContact<Dim>& at) {
        return part_bodies(at, pairs.motions(pair.a), pairs.motions(pair.b), most, dt);
      });
      if (n == 0) first = change;
      if (!(change > k_share * first)) break;
    }
    act(team);
  }

 private:
  /// Improves all impulses until they change the velocities by little of the largest speed.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void relax(const Team& team, double* part, double speed) const {
    constexpr int k_sweeps = 60;
    constexpr double k_small = 1e-8;  // of the speed
    MPM_ROLLED
    for (int n = 0; n < k_sweeps; ++n)
      if (!(sweep(team, part, [&](const RigidPair& pair, PairContact<Dim>& at) {
              return relax_contact(at, pairs.motions(pair.a), pairs.motions(pair.b), pair.friction);
            }) > k_small * speed))
        break;
  }
  /// Gap up to which a contact of a body may matter in the step [m].
  KOKKOS_INLINE_FUNCTION double slack(const PairBody<Dim>& body, const PairMotion<Dim>& motion) const {
    constexpr double k_touch = 1e-4;  // cells
    double linear = 0, angular = 0;
    for (int d = 0; d < Dim; ++d)
      linear += motion.before[d] * motion.before[d] + motion.velocity[d] * motion.velocity[d];
    for (int k = 0; k < k_turning_axes<Dim>; ++k)
      angular += motion.spin_before[k] * motion.spin_before[k] + motion.spin[k] * motion.spin[k];
    const double turn = angular > 0 ? Kokkos::sqrt(angular) * 2 * Kokkos::fmin(body.reach, room) : 0;
    return k_touch * spacing + 2 * dt * (Kokkos::sqrt(linear) + turn);
  }

  /// Gap [m] of a place at the end of the step without impulses.
  KOKKOS_INLINE_FUNCTION double ahead(const RigidPair& pair, const PairPlaces<Dim>& places,
                                      const Nearness<Dim>& found) const {
    const PairMotion<Dim>&a = pairs.motions(pair.a), &b = pairs.motions(pair.b);
    PairContact<Dim> at{};
    places.set(at, found);
    at.before = dot(parting_before(at, a, b), at.normal);
    return gap_after(at, a, b, dt);
  }

  /// The number of the contact with the largest score of all lanes; of several, the first.
  KOKKOS_INLINE_FUNCTION static int farthest(double score, int which) {
    const double most = largest_of_warp(score);
    constexpr double k_last = 2147483647;
    const double first = largest_of_warp(which >= 0 && score == most ? k_last - which : 0);
    return first > 0 ? static_cast<int>(k_last - first) : -1;
  }

  /// Keeps the contacts of pair m, each with its impulse of the step before.
  KOKKOS_INLINE_FUNCTION void keep(int m, const RigidPair& pair, const PairPlaces<Dim>& places,
                                   const int (&which)[k_most]) const {
    PairContact<Dim>* const at = pairs.contacts.data() + std::size_t(m) * k_most;
    int point[k_most], kept = 0;
    Vector<double, Dim> impulse[k_most];
    const int before = pairs.held(m);
    for (int k = 0; k < before; ++k) point[k] = at[k].point, impulse[k] = at[k].impulse;
    MPM_ROLLED
    for (int k = 0; k < k_most; ++k) {
      bool is_new = which[k] >= 0;
      for (int n = 0; n < kept; ++n) is_new = is_new && at[n].point != which[k];
      if (!is_new) continue;
      PairContact<Dim>& contact = at[kept++];
      const Nearness<Dim> found = places(which[k], pairs.points, pairs.vertices);
      contact.point = which[k], contact.impulse = {};
      places.set(contact, found);
      for (int n = 0; n < before; ++n)
        if (point[n] == which[k]) contact.impulse = impulse[n];
      set_bounds(contact, pairs.motions(pair.a), pairs.motions(pair.b), pair.restitution, dt);
    }
    pairs.held(m) = kept;
  }

  /// Begins a solution with an impulse of the step before: what of it presses.
  KOKKOS_INLINE_FUNCTION void resume(const RigidPair& pair, PairContact<Dim>& at) const {
    const double normal = Kokkos::fmax(0.0, dot(at.impulse, at.normal)), was = dot(at.impulse, at.normal);
    Vector<double, Dim> along;
    double square = 0;
    for (int d = 0; d < Dim; ++d) {
      along[d] = at.impulse[d] - was * at.normal[d];
      square += along[d] * along[d];
    }
    const double most = pair.friction * normal, length = Kokkos::sqrt(square);
    const double share = length > most ? most / length : 1;
    for (int d = 0; d < Dim; ++d) at.impulse[d] = normal * at.normal[d] + share * along[d];
    push_body(pairs.motions(pair.a), at.arms[0], at.impulse, 1);
    push_body(pairs.motions(pair.b), at.arms[1], at.impulse, -1);
  }

  /// The largest speed and change of speed of the bodies that a thread looks after, before contact [m/s].
  template <class Team>
  KOKKOS_INLINE_FUNCTION double fastest(const Team& team) const {
    double most = 0;
    MPM_ROLLED
    for (int n = team.team_rank(); n < count; n += team.team_size()) {
      const PairMotion<Dim>& motion = pairs.motions(n);
      for (int d = 0; d < Dim; ++d) {
        most = Kokkos::fmax(most, Kokkos::fabs(motion.before[d]));
        most = Kokkos::fmax(most, Kokkos::fabs(motion.velocity[d] - motion.before[d]));
      }
    }
    team.team_barrier();  // before impulses change the velocities
    sweep_pairs(team, [&](const RigidPair& pair, PairContact<Dim>& at) {
      resume(pair, at);
      return 0.0;
    });
    return most;
  }

  /// Calls f for the contacts of all pairs, colour by colour; returns the largest value of this thread.
  template <class Team, class F>
  KOKKOS_INLINE_FUNCTION double sweep_pairs(const Team& team, const F& f) const {
    double most = 0;
    MPM_ROLLED
    for (int c = 0; c < pairs.colours; ++c) {
      const int end = pairs.begin(c + 1);
      MPM_ROLLED
      for (int m = pairs.begin(c) + team.team_rank(); m < end; m += team.team_size()) {
        const int held = pairs.held(m);
        if (held == 0) continue;
        const RigidPair pair = pairs.list(m);
        MPM_ROLLED
        for (int k = 0; k < held; ++k)
          most = Kokkos::fmax(most, f(pair, pairs.contacts(std::size_t(m) * k_most + k)));
      }
      team.team_barrier();
    }
    return most;
  }
  template <class Team, class F>
  KOKKOS_INLINE_FUNCTION double sweep(const Team& team, double* part, const F& f) const {
    return largest(team, sweep_pairs(team, f), part);
  }

  /// The largest value of all threads of a team.
  template <class Team>
  KOKKOS_INLINE_FUNCTION static double largest(const Team& team, double value, double* part) {
    const double of_warp = largest_of_warp(value);
    const int rank = team.team_rank(), warps = (team.team_size() + k_warp - 1) / k_warp;
    if (rank % k_warp == 0) part[rank / k_warp] = of_warp;
    team.team_barrier();
    double most = 0;
    for (int w = 0; w < warps; ++w) most = Kokkos::fmax(most, part[w]);
    team.team_barrier();
    return most;
  }

  /// Leaves what the contacts do to the rigid bodies: a thread a body that moves, a warp a body that does
  /// not.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void act(const Team& team) const {
    for_team(team, count, [&](int n) {
      if (moves(pairs.motions(n))) leave(n, pairs.motions(n).impulse);
    });
    const int rank = team.team_rank(), size = team.team_size(), lanes = size < k_warp ? size : k_warp;
    const int lane = rank % lanes;
    MPM_ROLLED
    for (int first = rank - lane; first < count; first += size) {
      const int own = first + lane;
      double still = own < count && !moves(pairs.motions(own)) ? own + 1 : 0;
      MPM_ROLLED
      for (double most = largest_of_warp(still); most > 0; most = largest_of_warp(still)) {
        const int n = static_cast<int>(most) - 1;
        const Wrench<Dim> impulse = impulse_on(n, lane, lanes);
        if (lane == 0) leave(n, impulse);
        if (n == own) still = 0;
      }
    }
  }
  /// Leaves the impulse on rigid body n.
  KOKKOS_INLINE_FUNCTION void leave(int n, const Wrench<Dim>& impulse) const {
    PairAction<Dim>& action = pairs.actions(n);
    for (int k = 0; k < Wrench<Dim>::size; ++k) {
      action.wrench[k] = impulse[k] / dt;
      action.shift[k] = pairs.motions(n).shift[k];
      action.impulse[k] += impulse[k];
    }
  }

  /// Impulses of all contacts of a body that nothing moves, summed in an order that is always the same.
  KOKKOS_INLINE_FUNCTION Wrench<Dim> impulse_on(int n, int lane, int lanes) const {
    Wrench<Dim> sum{};
    MPM_ROLLED
    for (int m = lane; m < pairs.count; m += lanes) {
      const RigidPair pair = pairs.list(m);
      if (pair.a != n && pair.b != n) continue;
      const int own = pair.a == n ? 0 : 1;
      MPM_ROLLED
      for (int k = 0; k < pairs.held(m); ++k) {
        const PairContact<Dim>& at = pairs.contacts(std::size_t(m) * k_most + k);
        const AngularVector<Dim> moment = moment_of(at.arms[own], at.impulse);
        for (int d = 0; d < Dim; ++d) sum[Wrench<Dim>::force + d] += (own == 0 ? 1 : -1) * at.impulse[d];
        for (int d = 0; d < k_turning_axes<Dim>; ++d)
          sum[Wrench<Dim>::moment + d] += (own == 0 ? 1 : -1) * moment[d];
      }
    }
    for (int k = 0; k < Wrench<Dim>::size; ++k) sum[k] = sum_of_warp(sum[k]);
    return sum;
  }
};

}  // namespace mpm
