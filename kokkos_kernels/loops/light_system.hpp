#pragma once
// The velocity of light rigid bodies under the soil's contact (docs/method.md, "Light bodies").

#include "data/light_rigids.hpp"
#include "loops/node_update.hpp"
#include "physics/pair_contact.hpp"

namespace mpm {

/// Parts of the solution in a step of dt [s], before update_nodes. A round rehearses contact at the nodes
/// near light bodies, sums, and improves the velocity of each: begin, then rehearse, sum and solve in each
/// round.
template <class Space, class T, int Dim>
struct LightSystem {
  using Terms = LightTerms<Dim>;
  using Past = LightPast<Dim>;
  using Memory = typename Space::memory_space;
  static constexpr int cells = Patch<Dim>::cells, unknowns = Terms::unknowns;
  static constexpr int stride = UpdateNodes<Space, T, Dim>::light_stride;
  UpdateNodes<Space, T, Dim> update;
  Kokkos::View<LightMotion<Dim>*, Memory> motions;
  Kokkos::View<double*, Memory> of_slots, sums;
  NearBodies<Space> near;
  PairViews<Space, Dim> pairs;
  int slots;  // where a contact may be
  double dt;
  bool damps;  // the soil has local damping, whose forces are those of the solution without it

  LightSystem(const State<Space, T, Dim>& s, double step, bool damps)
      : update(node_update_of(s, step)),
        motions(s.light_rigids.motions),
        of_slots(s.light_rigids.of_slots),
        sums(s.light_rigids.sums),
        near(s.contact.near),
        pairs(s.pairs),
        slots(s.contact.count),
        dt(step),
        damps(damps) {}

  /// Doubles that a team needs for the nodes of a slot.
  int room() const { return near.width * Terms::size * stride; }

  /// Begins with the velocity that body r would have at the end of the step without contact with soil. What
  /// other rigid bodies do to it is taken as in the step before: else it would go into soil under their
  /// weight.
  KOKKOS_INLINE_FUNCTION void begin(int r) const {
    LightMotion<Dim>& motion = motions(r);
    motion.open = motion.light;
    for (int n = 0; n < Past::size; ++n) past(r)[n] = 0;
    if (!motion.light || damps) return;  // with damping it goes on from the solution without it
    const PairMotion<Dim> free = free_motion<T>(update.rigids(r), Wrench<Dim>{}, 0, dt);
    const Vector<double, Dim> pressed = impulse_of_others(r);
    for (int d = 0; d < Dim; ++d) motion.free.velocity[d] = free.velocity[d] + free.lightness[d] * pressed[d];
    motion.free.spin = free.spin;
    motion.end = motion.undamped = motion.free;
  }

  /// Whether the solution of some body near a slot goes on.
  KOKKOS_INLINE_FUNCTION bool is_open(int slot) const {
    for (int m = 0; m < near.width; ++m)
      if (is_open(slot, m)) return true;
    return false;
  }

  /// Sums what the nodes of a slot, number n of those near a rigid, do to the light bodies near it.
  /// of_nodes: room()
  template <class Team, class Sums>
  KOKKOS_INLINE_FUNCTION void rehearse(const Team& team, const Sums& nodes, int slot, int n,
                                       double* of_nodes) const {
    const int values = near.width * Terms::size;
    for_team(team, values * stride, [&](int v) { of_nodes[v] = 0; });
    team.team_barrier();
    for_team(team, cells, [&](int k) {
      if (update.owned_nodes.extent(0) == 0 || (update.owned_nodes(slot) >> k & 1) != 0)
        update.rehearse(nodes, slot * cells + k, damps, of_nodes + k % stride);
    });
    team.team_barrier();
    const int thread = team.team_rank(), size = team.team_size(), lanes = size < k_warp ? size : k_warp;
    for (int v = thread / k_warp; v < values; v += (size + k_warp - 1) / k_warp) {
      if (!is_open(slot, v / Terms::size)) continue;  // all threads of a warp together
      double sum = 0;
      for (int k = thread % k_warp; k < stride; k += lanes) sum += of_nodes[v * stride + k];
      sum = sum_of_warp(sum);
      if (thread % k_warp == 0) of_slots(n * values + v) = sum;
    }
  }

  /// Sums number v of the system of body r over the slots, in their order.
  KOKKOS_INLINE_FUNCTION void sum(int r, int v) const {
    double sum = 0;
    const int first = near.listed ? near.first(r) : 0, end = near.listed ? near.first(r + 1) : slots;
    for (int n = first; n < end && motions(r).open; ++n) {
      const int entry = near.listed ? near.place(n) : n * near.width + r;
      sum += of_slots(entry * Terms::size + v);
    }
    sums(r * Terms::size + v) = sum;
  }

  /// Counts the bodies of which the solution goes on.
  KOKKOS_INLINE_FUNCTION void count_open() const {
    const int count = static_cast<int>(motions.extent(0));
    int open = 0;
    for (int r = 0; r < count; ++r) open += motions(r).open;
    sums(count * Terms::size) = open;
  }

  /// Improves the velocity of body r: Newton's method for M (v - v_free) = J(v), with the change of the
  /// soil's impulse J by the nodes that are stopped now, and of those that slip as if a dashpot held them.
  /// Such steps descend, but are short where nodes slip: correct_step() lengthens them.
  KOKKOS_INLINE_FUNCTION void solve(int r) const {
    constexpr double k_small = sizeof(T) == sizeof(double) ? 1e-10 : 1e-6;  // of the velocity and its change
    LightMotion<Dim>& motion = motions(r);
    if (!motion.open) return;
    const PairMotion<Dim> free = free_motion<T>(update.rigids(r), Wrench<Dim>{}, 0, dt);
    const double* const system = &sums(r * Terms::size);
    double rows[unknowns][columns];
    double column[unknowns], end[unknowns], change[unknowns], residual[unknowns];
    for (int k = 0; k < unknowns; ++k) column[k] = system[Terms::impulse + k];
    yield(free, column);
    for (int k = 0; k < unknowns; ++k) {
      end[k] = k < Dim ? motion.end.velocity[k] : motion.end.spin[k - Dim];
      change[k] = end[k] - (k < Dim ? motion.free.velocity[k] : motion.free.spin[k - Dim]);
      rows[k][unknowns] = residual[k] = column[k] - change[k];
      rows[k][unknowns + 1] = past(r)[Past::residual + k] - residual[k];
    }
    for (int k = 0; k < unknowns; ++k) {
      for (int n = 0; n < unknowns; ++n) column[n] = system[Terms::loss_at(n < k ? k : n, n < k ? n : k)];
      yield(free, column);
      for (int n = 0; n < unknowns; ++n) rows[n][k] = column[n] + (n == k ? 1 : 0);
    }
    eliminate(rows);
    correct_step(free, residual, rows, past(r), column);
    for (int d = 0; d < Dim; ++d) motion.end.velocity[d] += column[d];
    for (int k = 0; k < k_turning_axes<Dim>; ++k) motion.end.spin[k] += column[Dim + k];
    const double most = k_small * k_small * (product_of(free, end, end) + product_of(free, change, change));
    motion.open = !(product_of(free, column, column) <= most);
    if (!damps) motion.undamped = motion.end;
  }

 private:
  /// Columns of the system: a matrix of the unknowns, the residual, and the change of the residual by the
  /// round before.
  static constexpr int columns = unknowns + 2;
  /// Numbers of LightPast of body r.
  KOKKOS_INLINE_FUNCTION double* past(int r) const {
    return &sums(light_numbers<Dim>(static_cast<int>(motions.extent(0))) + r * Past::size);
  }
  /// Change of a body's velocity by the solved system, corrected by Broyden's method where a part of the
  /// residual along the change of the round before is left; `past` keeps the new change and the residual. The
  /// correction is at most the change of the round before: a longer one would pass the velocity at which
  /// nodes begin to stick, and the rounds would go to and fro.
  KOKKOS_INLINE_FUNCTION static void correct_step(const PairMotion<Dim>& body,
                                                  const double (&residual)[unknowns],
                                                  const double (&rows)[unknowns][columns], double* past,
                                                  double (&step)[unknowns]) {
    double before[unknowns], taken[unknowns];
    for (int k = 0; k < unknowns; ++k) {
      before[k] = past[Past::step + k];
      taken[k] = past[Past::residual + k] - residual[k];
      step[k] = rows[k][unknowns];
    }
    const double left = product_of(body, before, residual), took = product_of(body, before, taken);
    if (left > 0 && took > 0) {
      const double more = Kokkos::fmin(1.0, left / took);
      for (int k = 0; k < unknowns; ++k) step[k] += more * (before[k] - rows[k][unknowns + 1]);
    }
    for (int k = 0; k < unknowns; ++k) {
      past[Past::step + k] = step[k];
      past[Past::residual + k] = residual[k];
    }
  }
  /// Whether the solution of body number m of those near a slot goes on.
  KOKKOS_INLINE_FUNCTION bool is_open(int slot, int m) const {
    const int r = near.body(slot, m);
    return r >= 0 && motions(r).open;
  }
  /// Impulse of other rigid bodies on body r in the step before [N s].
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> impulse_of_others(int r) const {
    Vector<double, Dim> sum{};
    for (int m = 0; m < pairs.count; ++m) {
      const RigidPair pair = pairs.list(m);
      if (pair.a != r && pair.b != r) continue;
      for (int k = 0; k < pairs.held(m); ++k)
        for (int d = 0; d < Dim; ++d)
          sum[d] +=
              (pair.a == r ? 1 : -1) * pairs.contacts(std::size_t(m) * k_pair_contacts<Dim> + k).impulse[d];
    }
    return sum;
  }
  /// From impulses on a body to changes of its velocity.
  KOKKOS_INLINE_FUNCTION static void yield(const PairMotion<Dim>& body, double (&numbers)[unknowns]) {
    AngularVector<Dim> moment;
    for (int k = 0; k < k_turning_axes<Dim>; ++k) moment[k] = numbers[Dim + k];
    moment = turned_by(body, moment);
    for (int d = 0; d < Dim; ++d) numbers[d] *= body.lightness[d];
    for (int k = 0; k < k_turning_axes<Dim>; ++k) numbers[Dim + k] = moment[k];
  }
  /// Product of two velocities and spins, the spins times the radius of gyration [m2/s2].
  KOKKOS_INLINE_FUNCTION static double product_of(const PairMotion<Dim>& body, const double (&a)[unknowns],
                                                  const double (&b)[unknowns]) {
    double lightness = 0, sum = 0;
    for (int d = 0; d < Dim; ++d) {
      lightness = Kokkos::fmax(lightness, body.lightness[d]);
      sum += a[d] * b[d];
    }
    for (int k = 0; k < k_turning_axes<Dim>; ++k) {
      double unit[unknowns] = {};
      unit[Dim + k] = 1;
      yield(body, unit);
      const bool both = lightness > 0 && unit[Dim + k] > 0;
      sum += a[Dim + k] * b[Dim + k] * (both ? lightness / unit[Dim + k] : 1);
    }
    return sum;
  }
  /// Solves a system by elimination with row exchanges; its last columns become the solutions.
  KOKKOS_INLINE_FUNCTION static void eliminate(double (&rows)[unknowns][columns]) {
    for (int k = 0; k < unknowns; ++k) {
      int largest = k;
      for (int n = k + 1; n < unknowns; ++n)
        if (Kokkos::fabs(rows[n][k]) > Kokkos::fabs(rows[largest][k])) largest = n;
      for (int m = k; m < columns; ++m) {
        const double value = rows[k][m];
        rows[k][m] = rows[largest][m], rows[largest][m] = value;
      }
      for (int n = 0; n < unknowns; ++n) {
        if (n == k) continue;
        const double factor = rows[n][k] / rows[k][k];
        for (int m = k; m < columns; ++m) rows[n][m] -= factor * rows[k][m];
      }
    }
    for (int k = 0; k < unknowns; ++k)
      for (int m = unknowns; m < columns; ++m) rows[k][m] /= rows[k][k];
  }
};

}  // namespace mpm
