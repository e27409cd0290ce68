#pragma once
// The strategy `tile`: the loop shape of a device or of a processor.

#include "loops/cpu/host_sums.hpp"
#include "loops/gpu/tile.hpp"

namespace mpm {

// On a device all patches at once, by atomic additions to the nodes.
template <class Source>
void sum_on_device(const Interpolation<Source>& it) {
  using Space = typename Source::Space;
  using T = typename Source::real;
  constexpr int Dim = Source::dim, cells = Patch<Dim>::cells;
  using Team = PatchTeam<Space, T, Dim>;
  using Tile_ = Tile<Source>;
  const auto source = it.source;
  const auto neighbours = it.patches.neighbours;
  const auto begin = it.bins.begin;
  const auto active_slots = it.bins.active_slots;
  const auto grid = it.grid;
  const WallReach<Dim> reach(grid);
  const auto origin = it.patches.origin;
  const auto out = it.out;
  const auto control = it.control;
  const int first = it.bins.first_active, teams = it.bins.last_active - first;
  if (teams == 0) return;

  Kokkos::parallel_for(
      "mpm::reduce_by_tile",
      light(Team(it.space, teams, team_threads<Space>)
                .set_scratch_size(0, Kokkos::PerTeam(Tile_::bytes() + k_scratch_slack))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (control().paused) return;
        const int slot = active_slots(first + team.league_rank());
        if (source.skips(slot)) return;
        const WindowImages<T, Dim> images(grid, reach, origin(slot));
        sum_patch(
            team, Scratch(team, Tile_::bytes()), source,
            [&](int n) {
              return number_at<decltype(neighbours), Dim>(neighbours, slot, window_coord<Dim>(images(n)));
            },
            [&](int c) { return begin(slot * cells + c); }, images, out);
      });
}

template <class Source>
void reduce_by_tile(const Interpolation<Source>& it) {
  if constexpr (is_device<typename Source::Space>)
    sum_on_device(it);
  else
    sum_on_host(it);
}

}  // namespace mpm
