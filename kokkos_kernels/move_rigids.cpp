#include "step_kernels.hpp"

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

/// Counts the step and adds what any point can have moved to the bound; moved_rigid, margin [cells]; late:
/// State::rebuild_late.
template <class T>
KOKKOS_INLINE_FUNCTION void end_step(Control& c, double moved_rigid, double margin, int late) {
  constexpr double epsilon = Kokkos::Experimental::epsilon<T>::value;  // round-off of a coordinate's update
  c.increment = Kokkos::fmax(c.moved, moved_rigid) + epsilon;
  c.moved = 0;
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
  const auto origin = s.patches.origin;
  const auto rigids = s.rigids;
  const double spacing = s.spacing;
  for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
    const auto points = s.rigid_points[r].points;
    if (points.surface_normal) continue;  // only a rebuild asks for them, and finds them itself
    const auto home = points.home;
    Kokkos::parallel_for(  // also while the steps are paused: it gives the same again
        "mpm::move_rigid_points", light(Kokkos::RangePolicy<Space>(s.space, 0, points.count)),
        KOKKOS_LAMBDA(int p) {
          const Coord<Dim> from = origin(points.cell(p) / Patch<Dim>::cells),
                           cell = coord_of<Dim>(points.cell(p));
          for (int d = 0; d < Dim; ++d)
            points.coordinate(p)[d] =
                static_cast<T>(home(p)[d] + rigids(r).displacement[d] / spacing - from[d] - cell[d]);
        });
  }
}

template <class Space, class T, int Dim>
void move_rigids(State<Space, T, Dim>& s, double dt) {
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int threads = is_device<Space> ? 128 : 1;
  const auto control = s.control;
  const auto sums = s.sums;
  const auto forces = s.slot_forces;
  const auto rigids = s.rigids;
  const auto origin = s.patches.origin;
  const double spacing = s.spacing, margin = s.p2g.margin;
  const int count = static_cast<int>(s.rigid_points.size()), values = Dim * count, slots = s.near_count;
  const int late = s.rebuild_late;

  Kokkos::parallel_for(
      "mpm::move_rigids", light(Team(s.space, 1, threads)),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (control().paused) return;
        for (int v = 0; v < values; ++v) {  // in an order that is always the same
          double sum = 0;
          Kokkos::parallel_reduce(
              Kokkos::TeamThreadRange(team, slots),
              [&](int n, double& part) { part += forces(n * values + v); }, sum);
          Kokkos::single(Kokkos::PerTeam(team), [&] { sums(v) = sum; });
        }
        team.team_barrier();  // also: no thread looks at `paused` any more
        Kokkos::single(Kokkos::PerTeam(team), [&] {
          double furthest = 0;  // m
          for (int r = 0; r < count; ++r)
            furthest = Kokkos::fmax(furthest, move_rigid(rigids(r), &sums(r * Dim), dt));
          end_step<T>(control(), furthest / spacing, margin, late);
        });
      });

  if (s.rigid_moves) move_rigid_points(s);
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
