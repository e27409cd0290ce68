#pragma once
// The serial team: one thread of a processor does what a team of threads does on a GPU.

#include <Kokkos_Core.hpp>

#include "base/spaces.hpp"

namespace mpm {

/// A team of one.
struct SerialTeam {
  int league = 0;
  KOKKOS_INLINE_FUNCTION int league_rank() const { return league; }
  KOKKOS_INLINE_FUNCTION static constexpr int team_rank() { return 0; }
  KOKKOS_INLINE_FUNCTION static constexpr int team_size() { return 1; }
  KOKKOS_INLINE_FUNCTION static void team_barrier() {}
};

/// Calls f(n) for n < count, by the threads of a team.
template <class Team, class F>
KOKKOS_INLINE_FUNCTION void for_team(const Team& team, int count, F&& f) {
  Kokkos::parallel_for(Kokkos::TeamThreadRange(team, count), f);
}
template <class F>
KOKKOS_INLINE_FUNCTION void for_team(const SerialTeam&, int count, F&& f) {
  for (int n = 0; n < count; ++n) f(n);
}

/// Calls f by one thread of a team.
template <class Team, class F>
KOKKOS_INLINE_FUNCTION void once(const Team& team, F&& f) {
  Kokkos::single(Kokkos::PerTeam(team), f);
}
template <class F>
KOKKOS_INLINE_FUNCTION void once(const SerialTeam&, F&& f) {
  f();
}

}  // namespace mpm
