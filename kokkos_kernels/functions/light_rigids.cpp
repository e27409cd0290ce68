#include "functions/light_rigids.hpp"

#include <vector>

#include "loops/cpu/host_soil.hpp"
#include "loops/light_system.hpp"

namespace mpm {
namespace {

template <class Space, class T, int Dim>
void rehearse_on_host(State<Space, T, Dim>& s, const LightSystem<Space, T, Dim>& system,
                      const Space& stream) {
  const HostSoil<Space, T, Dim> soil(s);
  const bool in_windows = s.summed.in_windows;
  const auto control = s.control;
  const auto slots = s.contact.slots;
  Kokkos::parallel_for("mpm::rehearse_light", Kokkos::RangePolicy<Space>(stream, 0, s.contact.count),
                       [=](int n) {
                         const int slot = slots(n);
                         if (control().paused || !system.is_open(slot)) return;
                         SlotSums<Space, T, Dim> sums;
                         soil.take(slot, in_windows, sums);
                         thread_local std::vector<double> of_nodes;  // so that a step allocates nothing
                         of_nodes.resize(system.room());
                         system.rehearse(SerialTeam{}, sums, slot, n, of_nodes.data());
                       });
}

template <class Space, class T, int Dim>
void rehearse_by_teams(State<Space, T, Dim>& s, const LightSystem<Space, T, Dim>& system,
                       const Space& stream) {
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr std::size_t k_fast = 32 * 1024;  // bytes that every back end has
  const int room = system.room();
  const std::size_t bytes = scratch_bytes<double>(room) + k_scratch_slack;
  const int level = bytes > k_fast ? 1 : 0;
  const auto control = s.control;
  const auto slots = s.contact.slots;
  Kokkos::parallel_for(
      "mpm::rehearse_light",
      light(Team(stream, s.contact.count, node_threads<Space, Dim>)
                .set_scratch_size(level, Kokkos::PerTeam(bytes))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        const int n = team.league_rank(), slot = slots(n);
        if (!control().paused && system.is_open(slot))
          system.rehearse(team, system.update.nodes, slot, n, scratch<double>(team, room, level));
      });
}

/// Runs work(n) for so many numbers, while the steps are not paused.
template <class Space, class T, int Dim, class Work>
void pass(const State<Space, T, Dim>& s, const Space& stream, const char* name, int count, const Work& work) {
  const auto control = s.control;
  Kokkos::parallel_for(
      name, light(Kokkos::RangePolicy<Space>(stream, 0, count)), KOKKOS_LAMBDA(int n) {
        if (!control().paused) work(n);
      });
}

}  // namespace

template <class Space, class T, int Dim>
void begin_light_rigids(State<Space, T, Dim>& s, double dt, bool damps, const Space& stream) {
  const LightSystem<Space, T, Dim> system(s, dt, damps);
  pass(
      s, stream, "mpm::begin_light", static_cast<int>(s.rigid_points.size()),
      KOKKOS_LAMBDA(int r) { system.begin(r); });
}

template <class Space, class T, int Dim>
void sum_light_rigids(State<Space, T, Dim>& s, double dt, bool damps, const Space& stream) {
  constexpr int numbers = LightTerms<Dim>::size;
  const int count = numbers * static_cast<int>(s.rigid_points.size());
  const LightSystem<Space, T, Dim> system(s, dt, damps);
  if constexpr (is_device<Space>)
    rehearse_by_teams(s, system, stream);
  else
    rehearse_on_host(s, system, stream);
  pass(
      s, stream, "mpm::sum_light", count + 1, KOKKOS_LAMBDA(int n) {
        if (n < count)
          system.sum(n / numbers, n % numbers);
        else
          system.count_open();
      });
}

template <class Space, class T, int Dim>
bool light_rigids_open(const State<Space, T, Dim>& s) {
  if constexpr (is_device<Space>)
    return true;
  else
    return s.light_rigids.sums(light_numbers<Dim>(static_cast<int>(s.rigid_points.size())) - 1) > 0;
}

template <class Space, class T, int Dim>
void solve_light_rigids(State<Space, T, Dim>& s, double dt, bool damps, const Space& stream) {
  const LightSystem<Space, T, Dim> system(s, dt, damps);
  pass(
      s, stream, "mpm::solve_light", static_cast<int>(s.rigid_points.size()),
      KOKKOS_LAMBDA(int r) { system.solve(r); });
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                 \
  template void begin_light_rigids(State<Space, T, Dim>&, double, bool, const Space&); \
  template void sum_light_rigids(State<Space, T, Dim>&, double, bool, const Space&);   \
  template bool light_rigids_open(const State<Space, T, Dim>&);                        \
  template void solve_light_rigids(State<Space, T, Dim>&, double, bool, const Space&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
