#include "transfer/save_state.hpp"

#include <algorithm>
#include <cmath>

#include "base/copy.hpp"
#include "functions/step_kernels.hpp"
#include "physics/rigid_motion.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/rebuild.hpp"
#include "rebuild/shift_particle.hpp"
#include "transfer/fill_view.hpp"

namespace mpm {
namespace {

template <class View>
SavedField save_field(const std::string& name, const View& view, int count) {
  using Value = typename View::non_const_value_type;
  constexpr int n = components_of<Value>;
  const auto host = mirror_of(view);
  SavedField field{name, n, static_cast<int>(sizeof(Number<Value>)), {}};
  field.values.resize(std::size_t(count) * n);
  const auto* numbers = reinterpret_cast<const Number<Value>*>(host.data());
  std::copy(numbers, numbers + field.values.size(), field.values.begin());
  return field;
}

/// Addresses of the cells where points are binned.
template <class Space, int Dim, class Cells>
std::vector<long> addresses_of(const Patches<Space, Dim>& patches, const Cells& cells, int count) {
  const auto cell = mirror_of(cells);
  const auto number = mirror_of(patches.number);
  std::vector<long> address(count);
  for (int p = 0; p < count; ++p) address[p] = address_of_node<Dim>(number, cell(p));
  return address;
}

template <class Patches_, class Points_>
SavedPoints save_points(const Patches_& patches, Points_ points) {
  SavedPoints saved;
  const auto id = mirror_of(points.id);
  saved.id.assign(id.data(), id.data() + points.count);
  saved.address = addresses_of(patches, points.cell, points.count);
  const auto save = [&](const ParticleField& row, const auto& field) {
    saved.fields.push_back(save_field(row.name, field, points.count));
  };
  for_each_field_of(save, points);
  return saved;
}

/// Gives particles in bins about nodes at upper walls (last_bins) the cell before, as addresses in a file are
/// those of cells in the mesh. A rebuild brings them back.
template <class T, int Dim>
void keep_in_mesh(const Grid<T, Dim>& grid, SavedPoints& saved) {
  const auto coordinate = std::find_if(saved.fields.begin(), saved.fields.end(),
                                       [](const SavedField& field) { return field.name == "coordinate"; });
  for (std::size_t p = 0; p < saved.address.size(); ++p) {
    Coord<Dim> cell = cell_of(grid, saved.address[p]);
    if (grid.holds(cell)) continue;
    for (int d = 0; d < Dim; ++d)
      if (cell[d] == grid.cells[d]) --cell[d], ++coordinate->values[p * Dim + d];
    saved.address[p] = grid.address_of(cell, grid.field_of(saved.address[p] / Patch<Dim>::cells));
  }
}

/// The lists of bodies near slots, on the host.
template <class Space>
NearBodies<Kokkos::DefaultHostExecutionSpace> on_host(const NearBodies<Space>& near) {
  NearBodies<Kokkos::DefaultHostExecutionSpace> host;
  host.listed = near.listed, host.width = near.width;
  if (near.listed) host.of = mirror_of(near.of);
  return host;
}
/// Calls f(number, body) for the bodies near a slot.
template <class Space, class F>
void for_each_near(const NearBodies<Space>& near, int slot, F&& f) {
  for (int n = 0; n < near.width; ++n)
    if (const int body = near.body(slot, n); body >= 0) f(n, body);
}

template <class Space, class T, int Dim>
SavedImpulse save_impulse(const ContactCore<Space, T, Dim>& s) {
  SavedImpulse saved;
  if (impulse_rows(s) == 0) return saved;
  const auto number = mirror_of(s.patches.number);
  const auto impulse = mirror_of(s.nodes.impulse);
  // One of several ranks owns a node: the values of the others may be long out of date.
  const auto owned_nodes = mirror_of(s.owned_nodes);
  const auto near = on_host(s.contact.near);
  const int rows = impulse_rows(s), stride = impulse_stride(s);
  const auto holds_some = [&](int i) {
    if (owned_nodes.extent(0) > 0 && (owned_nodes(i / Patch<Dim>::cells) >> (i % Patch<Dim>::cells) & 1) == 0)
      return false;
    for (int k = 0; k < rows; ++k)
      if (impulse(k, i) != 0 || std::signbit(impulse(k, i))) return true;
    return false;
  };
  for (int i = 0; i < s.patches.node_count(); ++i) {
    if (!holds_some(i)) continue;
    saved.address.push_back(address_of_node<Dim>(number, i));
    const std::size_t at = saved.values.size();
    saved.values.resize(at + impulse_numbers(s));
    for_each_near(near, i / Patch<Dim>::cells, [&](int n, int body) {
      for (int k = 0; k < stride; ++k) saved.values[at + body * stride + k] = impulse(n * stride + k, i);
    });
  }
  return saved;
}

/// Saves the sums over particles that left the run, and the cells whose particles are alone.
template <class Space, class T, int Dim>
void save_strays(const ContactCore<Space, T, Dim>& s, SavedState& saved) {
  const auto put_back = mirror_of(s.strays.put_back);
  for (std::size_t b = 0; b < s.strays.lost.size(); ++b) {
    const Lost& lost = s.strays.lost[b];
    const double numbers[k_lost] = {lost.count,       lost.mass,          lost.kinetic_energy,
                                    lost.momentum[0], lost.momentum[1],   lost.momentum[2],
                                    lost.merged,      lost.merged_energy, double(put_back(b)),
                                    lost.corrected,   lost.raised};
    saved.lost.insert(saved.lost.end(), numbers, numbers + k_lost);
  }
  saved.alone_known = s.strays.known ? 1 : 0;
  if (!s.strays.known) return;
  const auto alone = mirror_of(s.strays.alone);
  const auto number = mirror_of(s.patches.number);
  for (int c = 0; c < s.patches.node_count(); ++c)
    if (is_alone(alone, c)) saved.alone.push_back(address_of_node<Dim>(number, c));
  // Bins of nodes at upper walls have no address in a file; the next step then looks for such particles
  // again.
  const bool in_mesh = std::all_of(saved.alone.begin(), saved.alone.end(),
                                   [&](long address) { return s.grid.holds(cell_of(s.grid, address)); });
  if (!in_mesh) saved.alone.clear(), saved.alone_known = 0;
}

template <class Space, class T, int Dim>
void restore_lost(ContactCore<Space, T, Dim>& s, const SavedState& saved) {
  const auto put_back = Kokkos::create_mirror_view(s.strays.put_back);
  for (std::size_t b = 0; b < s.strays.lost.size(); ++b) {
    const double* const numbers = &saved.lost[b * k_lost];
    s.strays.lost[b] = {numbers[0], numbers[1], numbers[2], {numbers[3], numbers[4], numbers[5]},
                        numbers[6], numbers[7], numbers[9], numbers[10]};
    put_back(b) = static_cast<int>(numbers[8]);
  }
  copy(s.strays.put_back, put_back);
}

/// After the lists were made.
template <class Space, class T, int Dim>
void restore_alone(ContactCore<Space, T, Dim>& s, const SavedState& saved) {
  s.strays.known = saved.alone_known != 0;
  const auto alone = mirror_of(s.strays.alone);
  const auto slot_of = mirror_of(s.patches.slot_of);
  for (const long address : saved.alone)
    if (const int slot = slot_of(address / Patch<Dim>::cells); slot >= 0)
      alone(slot) |= std::uint64_t(1) << (address % Patch<Dim>::cells);
  copy(s.strays.alone, alone);
}

/// Makes a view hold n entries; its content is lost where it had another number.
template <class View>
void resize(View& view, std::size_t n) {
  const std::string label = view.label();
  if (view.extent(0) != n) view = View(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), n);
}

/// Puts a saved field into a view of `count` entries. False where there is none of its name and size.
template <class View>
bool restore_field(const std::string& name, View& view, const SavedPoints& saved, int count) {
  using Value = typename View::non_const_value_type;
  constexpr int n = components_of<Value>;
  const auto field = std::find_if(saved.fields.begin(), saved.fields.end(),
                                  [&](const SavedField& f) { return f.name == name; });
  if (field == saved.fields.end() || field->components != n || field->values.size() != std::size_t(count) * n)
    return false;
  resize(view, count);
  const auto host = Kokkos::create_mirror_view(view);
  auto* numbers = reinterpret_cast<Number<Value>*>(host.data());
  for (std::size_t k = 0; k < field->values.size(); ++k)
    numbers[k] = static_cast<Number<Value>>(field->values[k]);
  copy(view, host);
  return true;
}

template <class View>
void restore_whole(View& view, const std::vector<long>& values) {
  resize(view, values.size());
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t p = 0; p < values.size(); ++p)
    host(p) = static_cast<typename View::non_const_value_type>(values[p]);
  copy(view, host);
}

/// Room in the host's store for as many particles, where the soil goes in batches.
template <class Space, class T, int Dim>
void make_room(ContactCore<Space, T, Dim>& s, int count) {
  if (!s.batches.in_use() || count == s.soil.points.count) return;
  collect_soil(s);
  s.soil.points.count = s.soil.points.all = count;
  store_soil(s, count, s.scratch.extent(0));
}

/// Points with their addresses, not sorted yet. The name of a field that does not fit, or nothing.
template <class Space, class Points_>
std::string restore_points(ParticleSet<Space, Points_>& set, const SavedPoints& saved) {
  auto& points = set.points;
  points.count = points.all = static_cast<int>(saved.id.size());
  std::string missing;
  const auto restore = [&](const ParticleField& row, auto& view) {
    if (!restore_field(row.name, view, saved, points.count)) missing = row.name;
  };
  for_each_field_of(restore, points);
  restore_whole(points.id, saved.id);
  restore_whole(set.address, saved.address);
  restore_whole(points.cell, saved.address);  // sorting gives the cells; only the length counts
  return missing;
}

template <int Dim>
SavedRigid save_rigid(const Rigid<Dim>& rigid) {
  SavedRigid row{};
  for (int d = 0; d < Dim; ++d) {
    row[MotionTerms::displacement + d] = rigid.motion.pose.displacement[d];
    row[MotionTerms::velocity + d] = rigid.motion.velocity[d];
    row[MotionTerms::binned + d] = rigid.binned.displacement[d];
    row[MotionTerms::impulse + d] = rigid.impulse[Wrench<Dim>::force + d];
  }
  if (!rigid.motion.pose.turns) return row;
  row[MotionTerms::turns] = 1;
  rigid.motion.pose.rotation.store(&row[MotionTerms::rotation]);
  rigid.binned.rotation.store(&row[MotionTerms::binned_rotation]);
  for (int k = 0; k < k_turning_axes<Dim>; ++k) {
    row[MotionTerms::moment + k] = rigid.impulse[Wrench<Dim>::moment + k];
    row[MotionTerms::momentum + k] = rigid.momentum[k];
    row[MotionTerms::spin + k] = rigid.motion.spin[k];
  }
  return row;
}

template <int Dim>
void restore_rigid(const SavedRigid& row, Rigid<Dim>& rigid) {
  for (int d = 0; d < Dim; ++d) {
    rigid.motion.pose.displacement[d] = row[MotionTerms::displacement + d];
    rigid.motion.velocity[d] = row[MotionTerms::velocity + d];
    rigid.binned.displacement[d] = row[MotionTerms::binned + d];
    rigid.impulse[Wrench<Dim>::force + d] = row[MotionTerms::impulse + d];
  }
  if (row[MotionTerms::turns] == 0) return;  // it does not turn, or a stage has just placed it
  rigid.motion.pose.rotation = Rotation<Dim>::load(&row[MotionTerms::rotation]);
  rigid.binned.rotation = Rotation<Dim>::load(&row[MotionTerms::binned_rotation]);
  for (int k = 0; k < k_turning_axes<Dim>; ++k) {
    rigid.impulse[Wrench<Dim>::moment + k] = row[MotionTerms::moment + k];
    rigid.momentum[k] = row[MotionTerms::momentum + k];
    rigid.motion.spin[k] = row[MotionTerms::spin + k];
  }
  if (row[MotionTerms::turns] == MotionTerms::k_new_spin && rigid.inertia.dynamic)
    rigid.momentum = momentum_of(rigid.inertia.turning, rigid.motion.pose.rotation, rigid.motion.spin);
}

/// binned: the rigids stand where their points were binned, else where they are.
template <class Space, class T, int Dim>
void restore_rigids(ContactCore<Space, T, Dim>& s, const SavedState& saved, bool binned) {
  const auto host = mirror_of(s.rigids);
  for (std::size_t r = 0; r < saved.rigids.size(); ++r) {
    restore_rigid(saved.rigids[r], host(r));
    if (binned) host(r).motion.pose = host(r).binned;
  }
  copy(s.rigids, host);
}

/// The patches are those of the run, so each node that held something is there.
template <class Space, class T, int Dim>
void restore_nodes(ContactCore<Space, T, Dim>& s, const SavedImpulse& saved) {
  if (impulse_rows(s) == 0) return;
  s.nodes.impulse = decltype(s.nodes.impulse)("mpm::nodes.impulse", impulse_rows(s), s.patches.node_count());
  const auto host = mirror_of(s.nodes.impulse);
  const auto near = on_host(s.contact.near);
  const auto slot_of = mirror_of(s.patches.slot_of);
  // A body that a stage places or removes may have changed the numbers of each; those at nodes come first.
  const std::size_t rigids = s.rigid_points.size();
  const int stride = impulse_stride(s), was = numbers_of_rigid(saved, rigids), kept = std::min(stride, was);
  for (std::size_t n = 0; n < saved.address.size(); ++n) {
    const int slot = slot_of(saved.address[n] / Patch<Dim>::cells);
    if (slot < 0) continue;
    const int i = slot * Patch<Dim>::cells + static_cast<int>(saved.address[n] % Patch<Dim>::cells);
    for_each_near(near, slot, [&](int m, int body) {
      for (int k = 0; k < kept; ++k)
        host(m * stride + k, i) = static_cast<T>(saved.values[(n * rigids + body) * was + k]);
    });
  }
  copy(s.nodes.impulse, host);
}

template <class Space, class T, int Dim>
void restore_control(ContactCore<Space, T, Dim>& s, const SavedState& saved) {
  const auto control = mirror_of(s.control);
  control().bound = saved.bound;
  control().increment = saved.increment;
  control().due_in = s.rebuild_late > 0 ? saved.due_in : 0;
  control().paused = 0;
  copy(s.control, control);
}

}  // namespace

template <class Space, class T, int Dim>
SavedState save_state(const ContactCore<Space, T, Dim>& s) {
  s.space.fence("mpm::save_state");
  SavedState saved;
  const auto control = mirror_of(s.control);
  saved.bound = control().bound, saved.increment = control().increment;
  saved.margin = s.p2g.margin, saved.due_in = control().due_in;
  saved.soil = save_points(s.patches, s.soil.points);
  if (s.p2g.about_nodes) keep_in_mesh(s.grid, saved.soil);
  const auto rigids = mirror_of(s.rigids);
  for (std::size_t r = 0; r < s.rigid_points.size(); ++r) saved.rigids.push_back(save_rigid(rigids(r)));
  saved.impulse = save_impulse(s);
  save_strays(s, saved);
  return saved;
}

template <class Space, class T, int Dim>
std::string take_saved(ContactCore<Space, T, Dim>& s, const SavedState& saved) {
  if (saved.rigids.size() != s.rigid_points.size()) return "the number of rigids";
  if (saved.lost.size() != s.strays.lost.size() * k_lost) return "the number of bodies";
  restore_lost(s, saved);
  make_room(s, static_cast<int>(saved.soil.id.size()));
  const std::string missing = restore_points(s.soil, saved.soil);
  if (!missing.empty()) return missing;
  restore_rigids(s, saved, true);
  locate_rigids(s);
  return {};
}

template <class Space, class T, int Dim>
void finish_saved(ContactCore<Space, T, Dim>& s, const SavedState& saved) {
  restore_rigids(s, saved, false);
  move_rigid_points(s, s.space);
  restore_nodes(s, saved.impulse);
  restore_alone(s, saved);
  restore_control(s, saved);
  s.summed = {};
  s.space.fence("mpm::restore_state");
}

#define MPM_INSTANTIATE(Space, T, Dim)                                             \
  template SavedState save_state(const ContactCore<Space, T, Dim>& s);             \
  template std::string take_saved(ContactCore<Space, T, Dim>&, const SavedState&); \
  template void finish_saved(ContactCore<Space, T, Dim>&, const SavedState&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
