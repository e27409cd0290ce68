#include "end_step.hpp"
#include "particle_to_node.hpp"
#include "step_kernels.hpp"
#include "window.hpp"

namespace mpm {

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
  constexpr int threads = is_device<Space> ? 256 : 1;
  const EndStep<Space, T, Dim> end(s, dt);
  const int room = end.room(threads);
  const std::size_t bytes = scratch_bytes<double>(room);
  const int level = bytes > 32 * 1024 ? 1 : 0;
  Kokkos::parallel_for(
      "mpm::move_rigids",
      light(Team(s.space, 1, threads).set_scratch_size(level, Kokkos::PerTeam(bytes + k_scratch_slack))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!end.control().paused) end(team, scratch<double>(team, room, level));
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
