#include "end_step.hpp"
#include "host_particles.hpp"
#include "patch_update.hpp"

namespace mpm {
namespace {

constexpr int k_rigids_at_once = 4;  // whose points travel as arguments of one launch

/// The update and the end of the step in one launch: the first teams move the points of rigids to where they
/// will be and give their mass to the nodes, and the team that is done last moves the rigids and counts the
/// step.
template <class Space, class T, int Dim>
struct UpdateAndEnd {
  using Update = UpdateParticles<Space, T, Dim, true>;
  using Member = typename Update::Member;
  using Rigids = Kokkos::Array<RigidSource<Space, T, Dim>, k_rigids_at_once>;
  static constexpr int threads = Update::threads;
  Update update;
  EndStep<Space, T, Dim> end;
  Rigids rigids;
  int rigid_count, rigid_teams;
  decltype(Nodes<Space, T, Dim>::rigid) out;
  Kokkos::View<int, typename Space::memory_space> arrived;

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    const int n = team.league_rank() - rigid_teams;
    if (update.control().paused) return;
    Scratch scratch(team, Update::bytes());
    if (n < 0)
      rigids_to_nodes(team, Scratch(scratch).template take<double>(0));
    else
      update.update(team, scratch, update.slots(n));
    team.team_barrier();
    int earlier = 0;
    Kokkos::single(
        Kokkos::PerTeam(team),
        [&](int& teams) {
          Kokkos::memory_fence();  // what this team noted is there for the last one
          teams = Kokkos::atomic_fetch_add(&arrived(), 1);
        },
        earlier);
    if (earlier + 1 < team.league_size()) return;
    end(team, scratch.template take<double>(0));
    arrived() = 0;
  }

  KOKKOS_INLINE_FUNCTION void rigids_to_nodes(const Member& team, double* part) const {
    for (int k = 0; k < rigid_count; ++k) {
      const auto& source = rigids[k];
      const Vector<double, Dim> to = end.next_displacement(team, source.rigid, part);
      const int all = rigid_teams * threads;
      for (int p = team.league_rank() * threads + team.team_rank(); p < source.points.count; p += all) {
        source.move(p, to);
        give_to_nodes(source, update.around, p,
                      [&](int i, int v, T value) { Kokkos::atomic_add(&out(source.rigid, i, v), value); });
      }
    }
  }
};

/// Only on a device: a processor's caches hold the particles of a patch between the two functions anyway.
template <class Space, class T, int Dim>
inline constexpr bool sums_fit =
    is_device<Space>&& scratch_fits<Space, T, Dim>(UpdateParticles<Space, T, Dim, true>::bytes());

template <class Space, class T, int Dim>
UpdateScalars<T> update_scalars(const State<Space, T, Dim>& s, double dt) {
  const double flip = s.xpic_order > 0 ? 1 : s.flip_share;  // XPIC has changed the velocities already
  return {T(dt), s.grid.inv_spacing, T(flip), T(1 - flip), T(s.f_bar_share)};
}

template <bool Sums, class Space, class T, int Dim>
UpdateParticles<Space, T, Dim, Sums> update_of(const State<Space, T, Dim>& s, double dt, int first) {
  const auto& set = s.soil;
  const Kokkos::View<T*, typename Space::memory_space, Kokkos::MemoryUnmanaged> dilatation(
      reinterpret_cast<T*>(s.spare.data()), set.points.count);
  return {{set.points, s.grid.inv_spacing},
          set.bins.begin,
          set.bins.by_colour,
          s.patches.around,
          s.patches.origin,
          s.nodes.motion,
          s.nodes.soil,
          s.nodes.boundary,
          s.near_rigid,
          s.control,
          s.movements,
          dilatation,
          update_scalars(s, dt),
          s.spacing,
          first,
          set.points.bodies.extent(0) == 1,
          s.soil_boundary};
}

/// The launch of teams that work on patches.
template <class Update, class Space, class Functor>
void launch(const Space& space, int teams, const Functor& f) {
  if (teams == 0) return;
  Kokkos::parallel_for("mpm::update_particles",
                       light(typename Update::Team(space, teams, Update::threads)
                                 .set_scratch_size(0, Kokkos::PerTeam(Update::bytes() + k_scratch_slack))),
                       f);
}

template <bool Sums, class Space, class T, int Dim>
void launch_update(State<Space, T, Dim>& s, double dt, const Part<Space>& part) {
  launch<UpdateParticles<Space, T, Dim, Sums>>(part.space, part.last - part.first,
                                               update_of<Sums>(s, dt, part.first));
}

}  // namespace

template <class Space, class T, int Dim>
bool sums_ahead(const State<Space, T, Dim>& s) {
  return sums_fit<Space, T, Dim> && chosen(s.p2g.strategy, backend_of<Space>) == P2G::tile &&
         s.xpic_order == 0 && !s.affine;
}

template <class Space, class T, int Dim>
bool ends_at_once(const State<Space, T, Dim>& s) {
  int with_points = 0;
  for (const auto& set : s.rigid_points) with_points += !set.points.surface_normal;
  const std::size_t bytes = EndStep<Space, T, Dim>(s, 0).room(team_threads<Space>) * sizeof(double);
  return s.soil.points.count > 0 && sums_ahead(s) && few_patches(s) && !s.batches.in_use() &&
         with_points <= k_rigids_at_once && bytes <= UpdateParticles<Space, T, Dim, true>::bytes();
}

template <class Space, class T, int Dim>
void update_and_end(State<Space, T, Dim>& s, double dt) {
  if constexpr (sums_fit<Space, T, Dim>) {
    using Update = UpdateParticles<Space, T, Dim, true>;
    UpdateAndEnd<Space, T, Dim> f{update_of<true>(s, dt, 0), {s, dt}, {}, 0, 0, s.nodes.rigid, s.arrived};
    for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
      const auto& points = s.rigid_points[r].points;
      if (points.surface_normal) continue;
      f.rigids[f.rigid_count++] = {points, s.rigids, r, s.patches.origin, s.spacing};
      f.rigid_teams += (points.count + Update::threads - 1) / Update::threads;
    }
    launch<Update>(s.space, f.rigid_teams + s.soil.bins.colour_begin[Patch<Dim>::colours], f);
    s.summed = {true, s.soil_boundary, true};
  }
}

template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt, [[maybe_unused]] const Part<Space>& part) {
  const bool sums = sums_ahead(s);
  s.summed = {sums, sums && s.soil_boundary, false};
  if constexpr (is_device<Space>) {
    if constexpr (sums_fit<Space, T, Dim>)
      if (sums) return launch_update<true>(s, dt, part);
    launch_update<false>(s, dt, part);
  } else {
    move_on_host(s, update_scalars(s, dt));
  }
}

template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt) {
  update_particles(s, dt, Part<Space>{s.space, 0, s.soil.bins.colour_begin[Patch<Dim>::colours]});
}

#define MPM_INSTANTIATE(Space, T, Dim)                           \
  template bool sums_ahead(const State<Space, T, Dim>&);         \
  template bool ends_at_once(const State<Space, T, Dim>&);       \
  template void update_and_end(State<Space, T, Dim>&, double);   \
  template void update_particles(State<Space, T, Dim>&, double); \
  template void update_particles(State<Space, T, Dim>&, double, const Part<Space>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
