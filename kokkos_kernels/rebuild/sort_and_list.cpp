// A rebuild of the two lower floors: patches, order, lists and the room for nodal fields.

#include "rebuild/about_nodes.hpp"
#include "rebuild/list_pairs.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void sort_points_and_list(ContactCore<Space, T, Dim>& s) {
  const auto kept = keep_impulse(s);
  if (s.p2g.about_nodes) bring_to_nodes(s);
  activate_patches(s);
  sort_points(s);
  build_lists(s);
  if (s.interfaces.in_use()) list_interfaces(s);
  if (!s.rigid_points.empty() || s.interfaces.in_use()) list_contacts(s);
  if (impulse_rows(s) > 0) restore_impulse(s, kept);
  list_pairs(s);
  if (s.f_bar.fraction > 0 && s.p2g.about_nodes) note_cells(s);
  if (s.f_bar.fraction > 0 && !s.f_bar.keeps_stress)
    s.p2g.about_nodes ? average_pressure_of_cells(s) : average_pressure(s);
}

template <class Space, class T, int Dim>
void make_room(ContactCore<Space, T, Dim>& s, const NodeUses& uses) {
  s.summed = {};
  s.strays.known = false;
  s.split.parts.clear();
  ensure(s.strays.alone, s.patches.slots);
  Kokkos::deep_copy(s.space, s.strays.alone, 0);
  const int nodes = s.patches.node_count();
  const auto ensure_field = [nodes](const char*, bool in_use, auto& field) {
    if (in_use) ensure(field, nodes);
  };
  for_each_nodal_field(ensure_field, s.nodes, uses);
  if (s.mass_normals && static_cast<int>(s.nodes.rigid.extent(1)) < nodes)
    s.nodes.rigid = decltype(s.nodes.rigid)(
        Kokkos::view_alloc("mpm::nodes.rigid", Kokkos::WithoutInitializing), s.rigid_points.size(),
        nodes + (s.nodes.rigid.extent(1) > 0 ? nodes / 16 : 0));
  if (s.mass_normals && s.plan.writes_sums)
    Kokkos::deep_copy(s.space, s.nodes.rigid, T(0));  // only those near rigids are written
}

template <class Space, class T, int Dim>
void reset_bound(const Core<Space, T, Dim>& s) {
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::reset_bound", Kokkos::RangePolicy<Space>(s.space, 0, 1), KOKKOS_LAMBDA(int) {
        control().bound = 0;
        control().due_in = 0;
        control().lost = 0;
        control().paused = control().fault_count > 0;
      });
}

#define MPM_INSTANTIATE(Space, T, Dim)                                   \
  template void sort_points_and_list(ContactCore<Space, T, Dim>&);       \
  template void make_room(ContactCore<Space, T, Dim>&, const NodeUses&); \
  template void reset_bound(const Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
