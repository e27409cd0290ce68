#include "particle_to_node.hpp"
#include "step_kernels.hpp"
#include "warp.hpp"
#include "window.hpp"

namespace mpm {

/// Acceleration of a rigid [m/s2] under the force [N] of the soil on it (Eq. 7).
template <int Dim>
KOKKOS_INLINE_FUNCTION double acceleration(const Rigid<Dim>& rigid, int d, double contact) {
  return rigid.dynamic ? (rigid.force[d] + contact) / rigid.mass : 0;
}

/// Moves a rigid by a step, exactly where the force is constant. contact [N] is the force of the soil on it.
/// Returns the largest component of its movement [m].
template <int Dim>
KOKKOS_INLINE_FUNCTION double move_rigid(Rigid<Dim>& rigid, const double* contact, double dt) {
  double furthest = 0;
  for (int d = 0; d < Dim; ++d) {
    const double a = acceleration(rigid, d, contact[d]), step = dt * (rigid.velocity[d] + dt / 2 * a);
    furthest = Kokkos::fmax(furthest, Kokkos::fabs(step));
    rigid.displacement[d] += step;
    rigid.impulse[d] += dt * contact[d];
    rigid.velocity[d] += dt * a;
  }
  return furthest;
}

/// Counts the step and adds what any point can have moved to the bound; moved, margin [cells]; late:
/// State::rebuild_late.
template <class T>
KOKKOS_INLINE_FUNCTION void end_step(Control& c, double moved, double margin, int late) {
  constexpr double epsilon = Kokkos::Experimental::epsilon<T>::value;  // round-off of a coordinate's update
  c.increment = moved + epsilon;
  c.bound += c.increment;
  ++c.steps;
  const bool now = c.due_in == 1;
  if (c.due_in > 0)
    --c.due_in;
  else if (late > 0 && rebuild_due(c.bound, c.increment, margin, late))
    c.due_in = late;
  if (now || !(c.bound <= margin) || c.fault_count > 0) c.paused = 1;
}

template <class Space, class T, int Dim>
void move_rigid_points(State<Space, T, Dim>& s) {
  for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
    const auto points = s.rigid_points[r].points;
    if (points.surface_normal) continue;  // only a rebuild asks for them, and finds them itself
    const RigidSource<Space, T, Dim> source{points, s.rigids, r, s.patches.origin, s.spacing};
    Kokkos::parallel_for(  // also while the steps are paused: it gives the same again
        "mpm::move_rigid_points", light(Kokkos::RangePolicy<Space>(s.space, 0, points.count)),
        KOKKOS_LAMBDA(int p) { source.move(p); });
  }
}

template <class Space, class T, int Dim>
void move_rigids(State<Space, T, Dim>& s, double dt) {
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int threads = is_device<Space> ? 256 : 1, warps = (threads + k_warp - 1) / k_warp;
  const auto control = s.control;
  const auto movements = s.movements;
  const auto sums = s.sums;
  const auto forces = s.slot_forces;
  const auto rigids = s.rigids;
  const double spacing = s.spacing, margin = s.p2g.margin;
  const int count = static_cast<int>(s.rigid_points.size()), values = Dim * count, slots = s.near_count;
  const int late = s.rebuild_late;
  const std::size_t bytes = scratch_bytes<double>(warps * (values + 1));
  const int level = bytes > 32 * 1024 ? 1 : 0;

  Kokkos::parallel_for(
      "mpm::move_rigids",
      light(Team(s.space, 1, threads).set_scratch_size(level, Kokkos::PerTeam(bytes + k_scratch_slack))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (control().paused) return;
        const int thread = team.team_rank(), warp = thread / k_warp;
        double* const part = scratch<double>(team, warps * (values + 1), level);  // [values and moved][warps]
        const auto keep = [&](int v, double of_warp) {
          if (thread % k_warp == 0) part[v * warps + warp] = of_warp;
        };
        for (int v = 0; v < values; ++v) {  // in an order that is always the same
          double sum = 0;
          for (int n = thread; n < slots; n += threads) sum += forces(n * values + v);
          keep(v, sum_of_warp(sum));
        }
        double moved = 0;  // cells
        for (int n = thread; n < movements.places; n += threads)
          moved = Kokkos::fmax(moved, movements.take(n));
        keep(values, largest_of_warp(moved));
        team.team_barrier();  // also: no thread looks at `paused` any more
        Kokkos::parallel_for(Kokkos::TeamThreadRange(team, count), [&](int r) {
          for (int v = r * Dim; v < (r + 1) * Dim; ++v) {
            sums(v) = 0;
            for (int w = 0; w < warps; ++w) sums(v) += part[v * warps + w];
          }
          part[r * Dim * warps] = move_rigid(rigids(r), &sums(r * Dim), dt) / spacing;
        });
        team.team_barrier();
        Kokkos::single(Kokkos::PerTeam(team), [&] {
          moved = 0;
          for (int w = 0; w < warps; ++w) moved = Kokkos::fmax(moved, part[values * warps + w]);
          for (int r = 0; r < count; ++r) moved = Kokkos::fmax(moved, part[r * Dim * warps]);
          end_step<T>(control(), moved, margin, late);
        });
      });

  if (s.rigid_moves && !moves_points(strategy_of_rigids<Space>(s.p2g.strategy))) move_rigid_points(s);
}

template <class Space, class T, int Dim>
Control look(const State<Space, T, Dim>& s) {
  Control c;
  Kokkos::View<Control, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(&c);
  Kokkos::deep_copy(s.space, host, s.control);
  s.space.fence("mpm::look");
  return c;
}

template <class Space, class T, int Dim>
void restart_count(State<Space, T, Dim>& s) {
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::restart_count", Kokkos::RangePolicy<Space>(s.space, 0, 1),
      KOKKOS_LAMBDA(int) { control().steps = 0; });
}

#define MPM_INSTANTIATE(Space, T, Dim)                      \
  template void move_rigids(State<Space, T, Dim>&, double); \
  template void move_rigid_points(State<Space, T, Dim>&);   \
  template Control look(const State<Space, T, Dim>&);       \
  template void restart_count(State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
