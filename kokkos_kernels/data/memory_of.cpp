#include "data/memory_of.hpp"

namespace mpm {

template <class Space, class T, int Dim>
std::size_t memory_of(const ContactCore<Space, T, Dim>& s, const NodeUses& uses) {
  std::size_t bytes = 0;
  const auto add = [&](const auto& view) { bytes += bytes_of(view); };
  const auto add_set = [&](const auto& set) {
    add(set.points.cell), add(set.points.id), add(set.address), add(set.order);
    add(set.bins.begin), add(set.bins.active_slots), add(set.bins.list_begin), add(set.bins.list),
        add(set.bins.blocks), add(set.bins.windows.place), add(set.bins.windows.sums);
    auto points = set.points;
    for_each_field(points, add);
  };
  add_set(s.soil);
  for (const auto& set : s.rigid_points) add_set(set);
  add(s.patches.slot_of), add(s.patches.number), add(s.patches.origin), add(s.patches.neighbours),
      add(s.marks), add(s.scratch);
  for_each_nodal_field([&](const char*, bool, const auto& field) { add(field); }, s.nodes, uses);
  add(s.contact.near.of), add(s.contact.near.place);
  add(s.nodes.impulse), add(s.nodes.rigid), add(s.contact.place);
  for_each_table(s.vertices, add);
  add(s.strays.alone), add(s.split.slots);
  add(s.cell_means.place), add(s.cell_means.first), add(s.cell_means.sums);
  add(s.at_sites.sites), add(s.at_sites.gaps), add(s.at_sites.sums);
  const auto& list = s.at_sites.list;
  add(list.marks), add(list.open), add(list.first), add(list.node), add(list.group), add(list.pair);
  add(s.contact.boundary.sums), add(s.contact.strength.sums), add(s.contact.cloud.sums);
  for (const auto* more : {&s.launch.next_sums, &s.launch.last_sums})
    add(more->soil), add(more->boundary), add(more->rigid);
  add(s.interfaces.slots), add(s.interfaces.force), add(s.interfaces.sums);
  add(s.batches.room), add(s.batches.slots), add(s.flow.windows.sums);
  return bytes;
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template std::size_t memory_of(const ContactCore<Space, T, Dim>&, const NodeUses&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
