#include "functions/free_field.hpp"
#include "loops/cpu/host_nodes.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void reset_nodes(ContactCore<Space, T, Dim>& s) {
  using Team = Kokkos::TeamPolicy<Space>;
  s.summed = {}, s.launch.next_zero = false;
  if (s.plan.writes_sums) return;
  const auto nodes = s.nodes;
  const auto control = s.control;
  const int rigids = s.mass_normals ? static_cast<int>(s.rigid_points.size()) : 0;
  const bool boundary = s.soil_boundary;
  Kokkos::parallel_for(
      "mpm::reset_nodes", light(Team(s.space, s.patches.slots, node_threads<Space, Dim>)),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!control().paused) clear_sums(team, nodes, team.league_rank(), boundary, rigids);
      });
}

namespace {

/// So many teams share a multiprocessor that the nodes far from contact hide what it waits for.
inline constexpr int k_teams = 12;
template <class Space, int Dim, int teams = k_teams>
using NodeTeam = Kokkos::TeamPolicy<Space, Kokkos::LaunchBounds<node_threads<Space, Dim>, teams>>;
/// Teams of a launch of nodes near rigids alone: contact needs many registers.
inline constexpr int k_near_teams = 8;

/// Bytes of fast scratch memory of a team where so many teams are to share a multiprocessor.
template <class Space>
std::size_t fast_bytes(const Space& space, int teams) {
  constexpr std::size_t k_kept = 1024;  // that the device keeps of a team's share
  return space.cuda_device_prop().sharedMemPerMultiprocessor / teams - k_kept;
}

template <bool acts, class Space, class T, int Dim>
void update_nodes_by_teams(State<Space, T, Dim>& s, double dt, const Space& stream) {
  using Team = NodeTeam<Space, Dim>;
  using Member = typename Team::member_type;
  using Update = UpdateNodes<Space, T, Dim, acts>;
  const Update update = node_update_of<acts>(s, dt);
  const int room = update.value_count * Update::cells, values = update.value_count;
  const auto contact = s.contact.place, contact_slots = s.contact.slots;
  const auto control = s.control;
  const std::size_t near_bytes = scratch_bytes<double>(room) + k_scratch_slack;
  // Some rigids near a slot need more than its teams have.
  const int level = near_bytes > fast_bytes(s.space, s.plan.nodes_apart ? k_near_teams : k_teams) ? 1 : 0;
  const auto scratched = [&](auto policy) {
    return light(policy.set_scratch_size(level, Kokkos::PerTeam(near_bytes)));
  };
  // Without rigid bodies, slots of contact are those where deformable bodies meet, which press_fields takes.
  if (values > 0 && s.contact.count > 0 && !s.plan.nodes_apart)
    return Kokkos::parallel_for(
        "mpm::update_nodes", scratched(Team(s.space, s.patches.slots, node_threads<Space, Dim>)),
        KOKKOS_LAMBDA(const Member& team) {
          if (control().paused) return;
          const int slot = team.league_rank(), n = contact(slot);
          if (n > 0)
            update.update_near(team, update.nodes, slot, n - 1, scratch<double>(team, room, level));
          else
            update.update_far(team, update.nodes, slot);
        });
  Kokkos::parallel_for(
      "mpm::update_nodes", light(Team(s.space, s.patches.slots, node_threads<Space, Dim>)),
      KOKKOS_LAMBDA(const Member& team) {
        const int slot = team.league_rank();
        if (!control().paused && (values == 0 || contact(slot) == 0))
          update.update_far(team, update.nodes, slot);
      });
  if (s.plan.nodes_apart)
    Kokkos::parallel_for(
        "mpm::update_nodes_near_rigids",
        scratched(NodeTeam<Space, Dim, k_near_teams>(stream, s.contact.count, node_threads<Space, Dim>)),
        KOKKOS_LAMBDA(const Member& team) {
          const int n = team.league_rank();
          if (!control().paused)
            update.update_near(team, update.nodes, contact_slots(n), n, scratch<double>(team, room, level));
        });
}

}  // namespace

template <class Space, class T, int Dim>
void update_nodes(State<Space, T, Dim>& s, double dt, const Space& stream) {
  if (s.sides.has_columns()) advance_columns(s, dt);
  if constexpr (is_device<Space>)
    s.sides.in_use() || s.scheme.damping > 0 || s.rigid_turns || s.light_rigids.in_use ||
            s.vertices.has_parts() || (s.has_friction && s.flow.in_use())
        ? update_nodes_by_teams<true>(s, dt, stream)
        : update_nodes_by_teams<false>(s, dt, stream);
  else
    update_nodes_on_host(s, dt);
}

template <class Space, class T, int Dim>
void finish_sums(ContactCore<Space, T, Dim>& s) {
  if constexpr (!is_device<Space>) {
    if (s.summed.in_windows) give_nodes_on_host(s);
  }
  s.summed.in_windows = false;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                     \
  template void reset_nodes(ContactCore<Space, T, Dim>&);                  \
  template void update_nodes(State<Space, T, Dim>&, double, const Space&); \
  template void finish_sums(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
