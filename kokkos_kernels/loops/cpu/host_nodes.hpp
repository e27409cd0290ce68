#pragma once
// update_nodes on a processor.

#include <type_traits>
#include <vector>

#include "loops/cpu/host_soil.hpp"
#include "loops/node_update.hpp"

namespace mpm {

/// Updates the nodes of a slot: a row at once where neither walls nor rigids are near.
template <class Space, class T, int Dim>
struct HostNodes {
  static constexpr int cells = Patch<Dim>::cells, edge = Patch<Dim>::edge;
  using Sums = SlotSums<Space, T, Dim>;
  static_assert(std::is_trivially_copyable_v<Sums>, "threads would count the copies of a view in it");

  UpdateNodes<Space, T, Dim> update;
  HostSoil<Space, T, Dim> soil;
  bool in_windows, has_contact;

  HostNodes(const State<Space, T, Dim>& s, double dt)
      : update(node_update_of(s, dt)),
        soil(s),
        in_windows(s.summed.in_windows),
        has_contact(s.contact.count > 0) {}

  /// Prefetches the sums of a later slot.
  void fetch_sums(int slot) const {
    if (in_windows) soil.soil.nodes.fetch_windows(slot);
  }
  /// One piece of code, wherever the sums come from: so it rounds alike.
  void operator()(int slot) const {
    const int contact = has_contact ? soil.contact(slot) : 0;
    Sums sums;
    soil.take(slot, in_windows, sums);
    if (contact > 0) {
      thread_local std::vector<double> force;  // so that a step allocates nothing
      force.resize(update.value_count * cells);
      update.update_near(SerialTeam{}, sums, slot, contact - 1, force.data());
    } else if (inside(slot) && !update.has_friction) {
      update.update_rows(SerialTeam{}, sums, slot);
    } else {
      update.update_far(SerialTeam{}, sums, slot);
    }
  }

  /// Whether no node of a slot is at a wall.
  bool inside(int slot) const {
    const Coord<Dim> from = update.places.origin(slot);
    bool inside = true;
    for (int d = 0; d < Dim; ++d)
      inside = inside && from[d] > 0 && from[d] + edge <= update.places.grid.cells[d];
    return inside;
  }
};

/// A thread takes the nodes about the particles that it sums.
template <class Space, class T, int Dim>
void update_nodes_on_host(State<Space, T, Dim>& s, double dt) {
  const HostNodes<Space, T, Dim> nodes(s, dt);
  const Shared phases[] = {slots_about<Dim>(s.soil.bins, s.patches.slots)};
  constexpr int k_ahead = 2;  // slots: one is too little work to wait for
  for_each_shared("mpm::update_nodes", s.space, phases, [&](int, int slot) {
    if (s.control().paused) return;
    if (slot + k_ahead < s.patches.slots) nodes.fetch_sums(slot + k_ahead);
    nodes(slot);
  });
}

/// Brings to the nodes what the windows hold.
template <class Space, class T, int Dim>
void give_nodes_on_host(ContactCore<Space, T, Dim>& s) {
  const HostSoil<Space, T, Dim> soil(s);
  const Shared phases[] = {slots_about<Dim>(s.soil.bins, s.patches.slots)};
  for_each_shared("mpm::give_nodes", s.space, phases, [&](int, int slot) {
    if (!s.control().paused) soil.give_nodes(slot);
  });
}

}  // namespace mpm
