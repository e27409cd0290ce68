#pragma once
// Persistent steps, for small problems, whose time is that of launches and of waiting for memory: one launch
// does what several do in large problems. The program has them for GPUs (persistent_step.cpp); the tests have
// them for processors too, so that they are tested where there is no GPU.

#include "data/features_of.hpp"
#include "functions/step_kernels.hpp"
#include "loops/gpu/persistent_step.hpp"

#include <algorithm>

namespace mpm {
namespace persistent {

// More patches than this take their turns, and then what several teams compute of the nodes at a patch's rim
// costs more than a launch.
inline constexpr int k_most_patches = 1000;
inline constexpr long k_most_steps =
    1000;  // of one launch: a device that also shows pictures must not wait long

template <bool WithNodes, class Laws, ParticleDomain domain, class Space, class T, int Dim>
auto step_of(const State<Space, T, Dim>& s, double dt, int steps) {
  using Functor = PersistentStep<Space, T, Dim, WithNodes, Laws, domain>;
  Functor f{update_of<typename Functor::Update>(s, dt, s.soil.bins.active_slots, 0),
            node_update_of<false>(s, dt),
            {s, s.timed, dt},
            {},
            0,
            0,
            steps,
            {s.nodes, WithNodes ? s.launch.next_sums : s.nodes, s.launch.last_sums},
            s.launch.barrier,
            s.launch.movements};
  for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
    const auto& points = s.rigid_points[r].points;
    if (points.surface_normal) continue;
    f.rigids[f.rigid_count++] = {points, r};
    f.rigid_teams += (points.count + f.threads - 1) / f.threads;
  }
  return f;
}

template <class Space, class Functor>
void launch_functor(const Space& space, int slots, const Functor& f) {
  static_assert(!is_device<Space> || sizeof(Functor) <= 4000, "CUDA sends arguments of 4 KiB with a launch");
  typename Functor::Team team(space, f.rigid_teams + slots + 1, Functor::threads);
  Kokkos::parallel_for(
      "mpm::persistent_step",
      light(team.set_scratch_size(0, Kokkos::PerTeam(f.bytes(f.nodes.value_count) + k_scratch_slack))), f);
}

/// Calls f(laws, domain) with the choice of a persistent step for this soil, and returns what f returns;
/// false where there is none: domains that stretch have one for light laws alone, since each takes long to
/// compile.
template <class Space, class T, int Dim, class F>
bool with_choice(const State<Space, T, Dim>& s, F&& f) {
  constexpr std::integral_constant<ParticleDomain, ParticleDomain::fixed> fixed;
  constexpr std::integral_constant<ParticleDomain, ParticleDomain::stretch> stretch;
  if (s.soil.points.has_domain) return light_kernels_do(s) && f(LightMaterials{}, stretch);
  return light_kernels_do(s) ? f(LightMaterials{}, fixed) : f(Materials{}, fixed);
}

template <bool WithNodes, class Space, class T, int Dim>
void launch(const State<Space, T, Dim>& s, int slots, double dt, int steps) {
  with_choice(s, [&](auto laws, auto domain) {
    launch_functor(s.space, slots, step_of<WithNodes, decltype(laws), domain()>(s, dt, steps));
    return true;
  });
}

/// Makes sure that the sums of the next and of the last step have room, and that the next one's are zero.
template <class Space, class T, int Dim>
void prepare_sums(State<Space, T, Dim>& s) {
  if (s.launch.next_zero) return;
  const auto prepare = [&](auto& view, const auto& like) {
    if (view.layout() != like.layout())
      view = std::decay_t<decltype(view)>(Kokkos::view_alloc(like.label(), Kokkos::WithoutInitializing),
                                          like.layout());
    Kokkos::deep_copy(s.space, view, T(0));
  };
  for (NodeSums<Space, T, Dim>* sums : {&s.launch.next_sums, &s.launch.last_sums}) {
    prepare(sums->soil, s.nodes.soil);
    prepare(sums->boundary, s.nodes.boundary);
    prepare(sums->rigid, s.nodes.rigid);
  }
  s.launch.next_zero = true;
}

/// Whether a launch of this kind has room for its rigids.
template <bool WithNodes, class Space, class T, int Dim>
bool has_room(const State<Space, T, Dim>& s) {
  int with_points = 0;
  for (const auto& set : s.rigid_points) with_points += !set.points.surface_normal;
  const int values = wrench_size<Dim>(s.rigid_turns) * static_cast<int>(s.rigid_points.size());
  return with_choice(s, [&](auto laws, auto domain) {
    using Step = PersistentStep<Space, T, Dim, WithNodes, decltype(laws), domain()>;
    const std::size_t parts = EndStep<Space, T, Dim>(s, s.timed, 0).room(Step::threads) * sizeof(double);
    return with_points <= k_most_rigids && parts <= Step::Update::bytes() &&
           Step::bytes(values) <= k_team_bytes<Space> - k_scratch_slack - 8 * (Step::threads + 2);
  });
}

}  // namespace persistent

template <class Space, class T, int Dim>
bool ends_in_launch(const State<Space, T, Dim>& s) {
  if constexpr (is_device<Space> && sums_fit<Space, T, Dim>) return persistent::has_room<false>(s);
  return false;
}

template <class Space, class T, int Dim>
void update_and_end(State<Space, T, Dim>& s, double dt) {
  if constexpr (is_device<Space> && sums_fit<Space, T, Dim>) {
    persistent::launch<false>(s, s.soil.bins.last_active, dt, 1);
    s.summed = {true, s.soil_boundary, true};
  }
}

template <class Space, class T, int Dim>
bool can_persist(const State<Space, T, Dim>& s) {
  const bool summed = s.summed.soil && s.summed.boundary == s.soil_boundary && s.summed.rigids;
  const bool pays = s.launch.co_resident || s.patches.slots <= persistent::k_most_patches;
  if constexpr (sums_fit<Space, T, Dim>)
    return pays && summed && can(StepWay::many_steps, features_of(s)) && persistent::has_room<true>(s);
  return false;
}

template <class Space, class T, int Dim>
int run_persistent_steps(State<Space, T, Dim>& s, double dt, long most) {
  if constexpr (sums_fit<Space, T, Dim>) {
    const int steps = is_device<Space> && s.launch.co_resident
                          ? static_cast<int>(std::min(most, persistent::k_most_steps))
                          : 1;
    persistent::prepare_sums(s);
    persistent::launch<true>(s, s.patches.slots, dt, steps);
    NodeSums<Space, T, Dim>& sums = s.nodes;
    for (int n = 0; n < steps % 3; ++n) {
      std::swap(sums, s.launch.next_sums);  // and what was read is zero one step later
      std::swap(s.launch.next_sums, s.launch.last_sums);
    }
    return steps;
  }
  return 0;
}

template <class Space, class T, int Dim>
void resume_single_steps(State<Space, T, Dim>& s) {
  s.launch.co_resident = false;
  s.summed = {};  // the host has no record of whose turn the sums are
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::resume_single_steps", Kokkos::RangePolicy<Space>(s.space, 0, 1),
      KOKKOS_LAMBDA(int) { control().paused &= ~Pause::not_co_resident; });
}

/// Instances for a space, a real type and a dimension.
#define MPM_INSTANTIATE_PERSISTENT(Space, T, Dim)                         \
  template bool ends_in_launch(const State<Space, T, Dim>&);              \
  template void update_and_end(State<Space, T, Dim>&, double);            \
  template bool can_persist(const State<Space, T, Dim>&);                 \
  template int run_persistent_steps(State<Space, T, Dim>&, double, long); \
  template void resume_single_steps(State<Space, T, Dim>&);

}  // namespace mpm
