#include "functions/rigid_pairs.hpp"

#include "base/copy.hpp"

#include "loops/pair_solution.hpp"
#include "loops/window.hpp"

namespace mpm {
namespace {

template <class Space, class T, int Dim>
void launch(const PairSolution<Space, T, Dim>& solution, const Space& stream) {
  using Team = Kokkos::TeamPolicy<Space, Kokkos::LaunchBounds<256, 1>>;
  constexpr int threads = 256;
  const int bodies = static_cast<int>(solution.pairs.bodies.extent(0));
  Kokkos::parallel_for(
      "mpm::begin_pairs", light(Kokkos::RangePolicy<Space>(stream, 0, bodies)), KOKKOS_LAMBDA(int n) {
        if (!solution.control().paused) solution.begin(n);
      });
  Kokkos::parallel_for(
      "mpm::find_pair_contacts", light(Team(stream, solution.pairs.count, k_warp)),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!solution.control().paused) solution.find(team, team.league_rank());
      });
  const int room = threads / k_warp;
  const std::size_t bytes = scratch_bytes<double>(room) + k_scratch_slack;
  Kokkos::parallel_for(
      "mpm::solve_pairs", light(Team(stream, 1, threads).set_scratch_size(0, Kokkos::PerTeam(bytes))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!solution.control().paused) solution.solve(team, scratch<double>(team, room, 0));
      });
}

}  // namespace

template <class Space, class T, int Dim>
void contact_of_rigids(ContactCore<Space, T, Dim>& s, double dt, const Space& stream) {
  const PairSolution<Space, T, Dim> solution(s, dt);
  if constexpr (is_device<Space>) {
    launch(solution, stream);
  } else if (!s.control().paused) {
    const SerialTeam team{};
    double part = 0;
    for (int n = 0; n < static_cast<int>(solution.pairs.bodies.extent(0)); ++n) solution.begin(n);
    for (int m = 0; m < solution.pairs.count; ++m) solution.find(team, m);
    solution.solve(team, &part);
  }
}

template <class Space, class T, int Dim>
std::vector<PairAction<Dim>> take_pair_actions(ContactCore<Space, T, Dim>& s) {
  const auto host = mirror_of(s.pairs.actions);
  std::vector<PairAction<Dim>> actions(host.data(), host.data() + host.extent(0));
  const auto view = s.pairs.actions;
  Kokkos::parallel_for(
      "mpm::take_pair_impulse", Kokkos::RangePolicy<Space>(s.space, 0, view.extent(0)),
      KOKKOS_LAMBDA(int r) { view(r).impulse = Wrench<Dim>{}; });
  return actions;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                \
  template void contact_of_rigids(ContactCore<Space, T, Dim>&, double, const Space&); \
  template std::vector<PairAction<Dim>> take_pair_actions(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
