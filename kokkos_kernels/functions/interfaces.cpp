#include "functions/interfaces.hpp"

#include "base/copy.hpp"
#include "functions/step_kernels.hpp"
#include "loops/press_fields.hpp"

namespace mpm {
namespace {

/// press_fields for at most Most fields at a node, with the tractions at all nodes where `tractions` has room
/// for them.
template <int Most, class Space, class T, int Dim>
void press_places(State<Space, T, Dim>& s, double dt, const ControlView<Space>& control,
                  const Kokkos::View<double*, typename Space::memory_space>& tractions) {
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int cells = Patch<Dim>::cells;
  const auto of = s.interfaces;
  const PressFields<Space, T, Dim, Most> fields{node_update_of(s, dt), of, s.shear_fraction,
                                                s.owned_nodes.extent(0) == 0, tractions};
  const int values = of.rows * InterfaceTerms<Dim>::size, room = values * cells;
  const std::size_t bytes = scratch_bytes<double>(room) + k_scratch_slack;
  constexpr std::size_t k_fast = 32768;
  const int level = bytes > k_fast ? 1 : 0;
  Kokkos::parallel_for(
      "mpm::press_fields",
      Team(s.space, of.count, node_threads<Space, Dim>).set_scratch_size(level, Kokkos::PerTeam(bytes)),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (control().paused) return;
        double* const sums = scratch<double>(team, room, level);
        const int place = team.league_rank();
        for_team(team, cells, [&](int k) {
          for (int v = 0; v < values; ++v) sums[v * cells + k] = 0;
          fields(place, k, sums + k);
        });
        team.team_barrier();
        for_team(team, values, [&](int v) {
          double sum = 0;
          for (int k = 0; k < cells; ++k) sum += sums[v * cells + k];
          of.sums(std::size_t(place) * values + v) = sum;
        });
      });
}

template <class Space, class T, int Dim>
void press(State<Space, T, Dim>& s, double dt, const ControlView<Space>& control,
           const Kokkos::View<double*, typename Space::memory_space>& tractions = {}) {
  s.interfaces.fields == 2 ? press_places<2>(s, dt, control, tractions)
                           : press_places<k_most_fields>(s, dt, control, tractions);
}

}  // namespace

template <class Space, class T, int Dim>
void press_fields(State<Space, T, Dim>& s, double dt, bool in_step) {
  finish_sums(s);
  if (s.interfaces.count == 0) return;
  press(s, dt, in_step ? s.control : s.never_paused);
}

template <class Space, class T, int Dim>
void add_interface_totals(const State<Space, T, Dim>& s, const Space& stream) {
  const auto of = s.interfaces;
  if (of.count == 0 || of.rows == 0) return;
  const auto control = s.control;
  const int values = of.rows * InterfaceTerms<Dim>::size, count = of.count;
  using Team = Kokkos::TeamPolicy<Space>;
  Kokkos::parallel_for(
      "mpm::add_interfaces", Team(stream, values, is_device<Space> ? 128 : 1),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (control().paused) return;
        const int v = team.league_rank();
        double sum = 0;
        Kokkos::parallel_reduce(
            Kokkos::TeamThreadRange(team, count),
            [&](int place, double& part) { part += of.sums(std::size_t(place) * values + v); }, sum);
        Kokkos::single(Kokkos::PerTeam(team), [&] { of.totals(v) += sum; });
      });
}

template <class Space, class T, int Dim>
std::vector<InterfaceNode> interface_nodes(State<Space, T, Dim>& s, double dt) {
  using Traction = InterfaceTraction<Dim>;
  constexpr int cells = Patch<Dim>::cells;
  finish_sums(s);
  const auto& of = s.interfaces;
  const std::size_t pieces = std::size_t(of.count) * of.rows;
  std::vector<InterfaceNode> nodes;
  if (pieces == 0) return nodes;
  const Kokkos::View<double*, typename Space::memory_space> tractions("mpm::tractions",
                                                                      pieces * Traction::size * cells);
  press(s, dt, s.never_paused, tractions);
  const auto values = mirror_of(tractions);
  const auto slots = mirror_of(of.slots);
  const auto origin = mirror_of(s.patches.origin);
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const std::size_t place = piece / of.rows;
    int slot = -1;
    for (int f = 0; f < of.fields && slot < 0; ++f) slot = slots(place * of.fields + f);
    for (int k = 0; k < cells; ++k) {
      const auto value = [&](int v) { return values((piece * Traction::size + v) * cells + k); };
      InterfaceNode node{.row = static_cast<int>(piece % of.rows), .area = value(Traction::area)};
      bool pressed = false;
      for (int d = 0; d < Dim; ++d) {
        node.position[d] = double(origin(slot)[d] + coord_of<Dim>(k)[d]) * s.spacing;
        node.force[d] = value(Traction::force + d), node.normal[d] = value(Traction::normal + d);
        pressed = pressed || node.force[d] != 0;
      }
      if (pressed) nodes.push_back(node);
    }
  }
  return nodes;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                           \
  template void press_fields(State<Space, T, Dim>&, double, bool);               \
  template void add_interface_totals(const State<Space, T, Dim>&, const Space&); \
  template std::vector<InterfaceNode> interface_nodes(State<Space, T, Dim>&, double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
