#include "transfer/download.hpp"

#include <algorithm>
#include <numeric>

namespace mpm {

template <class Space, class T, int Dim>
SoilFields download_soil(const State<Space, T, Dim>& s) {
  const auto& soil = s.soil.points;
  const auto host_of = [&](const auto& view) {
    const auto held = Kokkos::subview(view, Kokkos::make_pair(0, soil.count));
    return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), held);
  };
  SoilFields fields;
  const auto id = host_of(soil.id);
  fields.id.assign(id.data(), id.data() + soil.count);
  std::vector<int> by_id(soil.count);  // particles in the order of id
  std::iota(by_id.begin(), by_id.end(), 0);
  std::sort(by_id.begin(), by_id.end(), [&](int p, int q) { return fields.id[p] < fields.id[q]; });
  std::sort(fields.id.begin(), fields.id.end());

  const auto spread = [&](const auto& view, int width, std::vector<double>& out, auto&& component) {
    const auto host = host_of(view);
    out.reserve(std::size_t(soil.count) * width);
    for (const int p : by_id)
      for (int k = 0; k < width; ++k) out.push_back(component(host(p), k));
  };
  const auto part = [](const auto& value, int k) { return double(value[k]); };
  const auto whole = [](const auto& value, int) { return double(value); };
  spread(soil.velocity, Dim, fields.velocity, part);
  spread(soil.stress, sym_size<Dim>, fields.stress, part);
  spread(soil.volume, 1, fields.volume, whole);
  fields.history.resize(soil.history.columns);
  for (int k = 0; k < soil.history.columns; ++k) spread(soil.history.column[k], 1, fields.history[k], whole);
  const auto bodies = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), soil.bodies);
  const auto of_body = [&](int b, int) { return double(bodies(b).mass); };
  if (soil.has_own_mass)
    spread(soil.mass, 1, fields.mass, whole);
  else
    spread(soil.body, 1, fields.mass, of_body);

  const auto x_p = host_of(soil.coordinate);
  const auto cell = host_of(soil.cell);
  const auto origin = Kokkos::create_mirror_view_and_copy(
      Kokkos::HostSpace(), Kokkos::subview(s.patches.origin, Kokkos::make_pair(0, s.patches.slots)));
  for (const int p : by_id) {
    const Coord<Dim> from = origin(cell(p) / Patch<Dim>::cells), in = coord_of<Dim>(cell(p));
    for (int d = 0; d < Dim; ++d)
      fields.position.push_back((double(from[d] + in[d]) + double(x_p(p)[d])) * s.spacing);
  }
  return fields;
}

template <class Space, class T, int Dim>
std::vector<double> download_rigid_positions(const State<Space, T, Dim>& s, int rigid) {
  const auto& points = s.rigid_points[rigid].points;
  const auto home = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), points.home);
  const auto id = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), points.id);
  const auto rigids = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), s.rigids);
  std::vector<double> position(std::size_t(points.all) * Dim);
  for (int p = 0; p < points.all; ++p)
    for (int d = 0; d < Dim; ++d)
      position[std::size_t(id(p)) * Dim + d] = home(p)[d] * s.spacing + rigids(rigid).displacement[d];
  return position;
}

template <class Space, class T, int Dim>
std::vector<Rigid<Dim>> take_rigids(State<Space, T, Dim>& s) {
  auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), s.rigids);
  std::vector<Rigid<Dim>> rigids(host.data(), host.data() + host.extent(0));
  const auto view = s.rigids;
  Kokkos::parallel_for(
      "mpm::take_impulse", Kokkos::RangePolicy<Space>(s.space, 0, view.extent(0)),
      KOKKOS_LAMBDA(int r) { view(r).impulse = filled<double, Dim>(0); });
  return rigids;
}

template <class Space, class T, int Dim>
std::size_t memory_of(const State<Space, T, Dim>& s) {
  std::size_t bytes = 0;
  const auto add = [&](const auto& view) {
    const bool at_host = view.use_count() == 0;  // memory of Batches::store
    if (!at_host) bytes += view.span() * sizeof(*view.data());
  };
  const auto add_set = [&](const auto& set) {
    add(set.points.cell), add(set.points.id), add(set.address), add(set.order);
    add(set.bins.begin), add(set.bins.by_colour), add(set.bins.list_begin), add(set.bins.list),
        add(set.bins.blocks), add(set.bins.windows.place), add(set.bins.windows.sums);
    auto points = set.points;
    for_each_field(points, add);
  };
  add_set(s.soil);
  for (const auto& set : s.rigid_points) add_set(set);
  add(s.patches.slot_of), add(s.patches.number), add(s.patches.origin), add(s.patches.around), add(s.marks),
      add(s.spare);
  add(s.nodes.soil), add(s.nodes.motion), add(s.nodes.rest), add(s.nodes.boundary), add(s.nodes.impulse);
  add(s.nodes.strength), add(s.nodes.rigid), add(s.near_rigid), add(s.vertices), add(s.strays.alone);
  add(s.boundary_windows.sums), add(s.strength_windows.sums);
  for (const auto* more : {&s.next_sums, &s.last_sums})
    add(more->soil), add(more->boundary), add(more->rigid);
  add(s.batches.room), add(s.batches.slots);
  return bytes;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                     \
  template SoilFields download_soil(const State<Space, T, Dim>&);                          \
  template std::vector<double> download_rigid_positions(const State<Space, T, Dim>&, int); \
  template std::vector<Rigid<Dim>> take_rigids(State<Space, T, Dim>&);                     \
  template std::size_t memory_of(const State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
