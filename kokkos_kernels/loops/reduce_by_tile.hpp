#pragma once
// The strategy `tile`: the loop shape of a device or of a processor.

#include "loops/cpu/host_sums.hpp"
#include "loops/gpu/tile.hpp"

namespace mpm {

// On a device all patches at once, by atomic additions to the nodes; where some patches alone give, these. Of
// few, each lot of a patch has a team: one wave of teams takes as long as one of them.
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
  const auto grid = it.grid;
  const WallReach<Dim> reach(grid);
  const auto origin = it.patches.origin;
  const auto out = it.out;
  const auto control = it.control;
  constexpr int k_few = 1024;  // slots that give
  const bool few = it.giving >= 0 && it.giving<k_few, listed = it.giving_slots.extent(0)> 0;
  const auto list = listed ? it.giving_slots : it.bins.active_slots;
  const int first = listed ? 0 : it.bins.first_active;
  const int slots = listed ? it.giving : it.bins.last_active - first;
  if (slots == 0) return;
  const int parts = few ? Tile_::lots : 1, lots = Tile_::lots / parts;

  Kokkos::parallel_for(
      "mpm::reduce_by_tile",
      light(Team(it.space, slots * parts, team_threads<Space>)
                .set_scratch_size(0, Kokkos::PerTeam(Tile_::bytes() + k_scratch_slack))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (control().paused) return;
        const int slot = list(first + team.league_rank() / parts);
        if (source.skips(slot)) return;
        const WindowImages<T, Dim> images(grid, reach, origin(slot));
        sum_patch(
            team, Scratch(team, Tile_::bytes()), source,
            [&](int n) {
              return number_at<decltype(neighbours), Dim>(neighbours, slot, window_coord<Dim>(images(n)));
            },
            [&](int c) { return begin(slot * cells + c); }, images, out,
            Lots{team.league_rank() % parts * lots, lots});
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
