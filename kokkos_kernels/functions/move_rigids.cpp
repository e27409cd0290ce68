#include <vector>

#include "base/copy.hpp"
#include "base/ensure.hpp"
#include "functions/step_kernels.hpp"
#include "loops/end_step.hpp"
#include "loops/particle_to_node.hpp"
#include "loops/window.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void move_rigid_points(ContactCore<Space, T, Dim>& s, const Space& stream) {
  for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
    const auto points = s.rigid_points[r].points;
    if (points.surface_normal) continue;  // only a rebuild asks for them, and finds them itself
    const RigidSource<Space, T, Dim> source{points, s.rigids, r, s.patches.origin, s.spacing};
    constexpr int k_few = 2000;  // one thread is done with them before the others have come together
    if (!is_device<Space> && points.count < k_few) {
      for (int p = 0; p < points.count; ++p) source.move(p);
      continue;
    }
    Kokkos::parallel_for(  // also while the steps are paused: it gives the same again
        "mpm::move_rigid_points", light(Kokkos::RangePolicy<Space>(stream, 0, points.count)),
        KOKKOS_LAMBDA(int p) { source.move(p); });
  }
}

namespace {

template <class Space, class T, int Dim, class Work>
void launch_end_by_teams(const EndStep<Space, T, Dim>& end, const Space& stream, int teams,
                         const Work& work) {
  constexpr int k_most = 1024, k_few = 32;  // threads; few slots are near one of many bodies
  using Team = Kokkos::TeamPolicy<Space, Kokkos::LaunchBounds<k_most, 1>>;
  const int threads = teams > 1 && end.near.listed ? k_few : k_most;
  const int room = end.room(threads, Work::shares);
  const std::size_t bytes = scratch_bytes<double>(room);
  const int level = bytes > 32 * 1024 ? 1 : 0;
  Kokkos::parallel_for(
      "mpm::end_step",
      light(Team(stream, teams, threads).set_scratch_size(level, Kokkos::PerTeam(bytes + k_scratch_slack))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!end.control().paused) work(end, team, scratch<double>(team, room, level));
      });
}

/// Teams of a thousand threads, which sum the forces of thousands of slots: `work` does what one of them
/// does. On a processor one thread does it all, before the others would have come together.
template <class Space, class T, int Dim, class Work>
void launch_end(const EndStep<Space, T, Dim>& end, const Space& stream, int teams, const Work& work) {
  if constexpr (is_device<Space>) {
    launch_end_by_teams(end, stream, teams, work);
  } else {
    std::vector<double> part(end.room(1, Work::shares));
    for (int team = 0; team < teams && !end.control().paused; ++team)
      work(end, SerialTeam{team}, part.data());
  }
}

struct Sum {
  static constexpr int shares = 1;
  template <class End, class Team>
  KOKKOS_INLINE_FUNCTION void operator()(const End& end, const Team& team, double* part) const {
    end.sum(team, team.league_rank(), part);
  }
};

/// Moves many bodies by a thread each, and leaves in `moved` how far [cells]: in one team they would wait for
/// each other. The forces on them are summed.
template <class Space, class T, int Dim>
void move_by_threads(const EndStep<Space, T, Dim>& end, const Space& stream,
                     const Kokkos::View<double*, typename Space::memory_space>& moved) {
  Kokkos::parallel_for(
      "mpm::move_many_rigids", light(Kokkos::RangePolicy<Space>(stream, 0, end.count)), KOKKOS_LAMBDA(int r) {
        if (!end.control().paused) moved(r) = end.move_one(r);
      });
}

/// MayTurn: some rigid body turns, touches others, is joined or is not near all slots; without, the kernel
/// is short. of: shares of the sum of each force.
template <bool MayTurn, int of>
struct Move {
  static constexpr int shares = of;
  template <class End, class Team>
  KOKKOS_INLINE_FUNCTION void operator()(const End& end, const Team& team, double* part) const {
    end.template end<MayTurn, of>(team, part);
  }
};

}  // namespace

template <class Space, class T, int Dim>
void sum_forces(ContactCore<Space, T, Dim>& s, const Space& stream) {
  const int wrenches = static_cast<int>(s.rigid_points.size()) + s.part_forces.count;
  const int values = wrench_size<Dim>(s.rigid_turns) * wrenches;
  if (values > 0) launch_end(EndStep<Space, T, Dim>(s, {}, 0), stream, values, Sum{});
  s.forces_summed = true;
}

namespace {

/// Whether a launch of its own moves the rigids: they are many, and no links move them.
template <class Space, class T, int Dim>
bool moves_many(const ContactCore<Space, T, Dim>& s) {
  return is_device<Space> && s.contact.near.listed && !s.links.in_use();
}

template <class Space, class T, int Dim>
EndStep<Space, T, Dim> end_of(const ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& timed,
                              double dt) {
  EndStep<Space, T, Dim> end(s, timed, dt);
  if (!s.links.in_use() && s.pairs.in_use()) end.pairs = s.pairs.actions;
  return end;
}

}  // namespace

template <class Space, class T, int Dim>
void move_many_rigids(ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& timed, double dt,
                      const Space& stream) {
  if (!moves_many(s)) return;
  if (!s.forces_summed) sum_forces(s, stream);
  ensure(s.rigid_moved, s.rigid_points.size());
  move_by_threads(end_of(s, timed, dt), stream, s.rigid_moved);
}

template <class Space, class T, int Dim>
void move_rigids(ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& timed, double dt,
                 const Space& stream) {
  if (!s.rigids_ahead) move_many_rigids(s, timed, dt, stream);
  EndStep<Space, T, Dim> end = end_of(s, timed, dt);
  if (s.links.in_use() || moves_many(s)) end.moved = s.rigid_moved.data();
  // Persistent steps, of few patches, sum each force in one share: a run gives the same bits by both.
  constexpr int k_many = 256, k_shares = is_device<Space> ? 16 : 1;
  const bool many = s.plan.form != StepForm::persistent && !s.contact.near.listed && s.contact.count > k_many;
  const bool plain = !s.rigid_turns && !s.pairs.in_use() && !s.contact.near.listed;
  if (!plain || end.moved != nullptr)
    launch_end(end, stream, 1, Move<true, 1>{});
  else if (many)
    launch_end(end, stream, 1, Move<false, k_shares>{});
  else
    launch_end(end, stream, 1, Move<false, 1>{});
  s.forces_summed = s.rigids_ahead = false;
  if (s.rigid_moves && !moves_points(strategy_of_rigids<Space>(s.p2g.strategy))) move_rigid_points(s, stream);
}

template <class Space, class T, int Dim>
void begin_loads(const ContactCore<Space, T, Dim>& s, const TimedLoads<Space, T, Dim>& loads,
                 const LoadClock& clock) {
  const LoadsOfStep<T, Dim> timed = loads.of_step();
  if (timed.count == 0) return;
  Rigid<Dim>* const rigids = s.rigids.data();
  Kokkos::parallel_for(
      "mpm::begin_loads", Kokkos::RangePolicy<Space>(s.space, 0, timed.count), KOKKOS_LAMBDA(int n) {
        if (n == 0) *timed.clock = clock;
        timed.set(n, clock, 0, rigids);
      });
}

template <class Space, class T, int Dim>
Control read_control(const Core<Space, T, Dim>& s) {
  Control c;
  Kokkos::View<Control, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(&c);
  copy(s.space, host, s.control);
  s.space.fence("mpm::read_control");
  return c;
}

template <class Space, class T, int Dim>
void restart_count(const Core<Space, T, Dim>& s) {
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::restart_count", Kokkos::RangePolicy<Space>(s.space, 0, 1),
      KOKKOS_LAMBDA(int) { control().steps = 0; });
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                  \
  template void sum_forces(ContactCore<Space, T, Dim>&, const Space&);                                  \
  template void move_many_rigids(ContactCore<Space, T, Dim>&, const TimedLoads<Space, T, Dim>&, double, \
                                 const Space&);                                                         \
  template void move_rigids(ContactCore<Space, T, Dim>&, const TimedLoads<Space, T, Dim>&, double,      \
                            const Space&);                                                              \
  template void move_rigid_points(ContactCore<Space, T, Dim>&, const Space&);                           \
  template void begin_loads(const ContactCore<Space, T, Dim>&, const TimedLoads<Space, T, Dim>&,        \
                            const LoadClock&);                                                          \
  template Control read_control(const Core<Space, T, Dim>&);                                            \
  template void restart_count(const Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
