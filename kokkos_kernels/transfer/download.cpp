#include "transfer/download.hpp"

#include <algorithm>
#include <numeric>

#include "base/copy.hpp"
#include "base/number_of.hpp"
#include "physics/domain.hpp"

namespace mpm {

template <class Space, class T, int Dim>
std::vector<int> order_for_host(const ContactCore<Space, T, Dim>& s) {
  const auto& soil = s.soil.points;
  const auto held = Kokkos::make_pair(0, soil.count);
  const auto id = mirror_of(Kokkos::subview(soil.id, held));
  const auto body = mirror_of(Kokkos::subview(soil.body, held));
  std::vector<int> order(soil.count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int p, int q) { return body(p) != body(q) ? body(p) < body(q) : id(p) < id(q); });
  return order;
}

template <class Space, class T, int Dim>
SoilFields download_soil(const ContactCore<Space, T, Dim>& s) {
  const auto& soil = s.soil.points;
  const auto host_of = [&](const auto& view) {
    const auto held = Kokkos::subview(view, Kokkos::make_pair(0, soil.count));
    return mirror_of(held);
  };
  SoilFields fields;
  const auto id = host_of(soil.id);
  const std::vector<int> by_id = order_for_host(s);
  for (const int p : by_id) fields.id.push_back(id(p));
  const auto body = host_of(soil.body);
  fields.first.assign(soil.bodies.extent(0) + 1, 0);
  for (int p = 0; p < soil.count; ++p) ++fields.first[body(p) + 1];
  std::partial_sum(fields.first.begin(), fields.first.end(), fields.first.begin());

  const auto spread = [&](const auto& view, int width, std::vector<double>& out, auto&& component) {
    const auto host = host_of(view);
    out.reserve(std::size_t(soil.count) * width);
    for (const int p : by_id)
      for (int k = 0; k < width; ++k) out.push_back(component(host(p), k));
  };
  const auto part = [](const auto& value, int k) {
    return double(reinterpret_cast<const Number<std::decay_t<decltype(value)>>*>(&value)[k]);
  };
  const auto spread_column = [&](const ParticleField& row, const auto& view) {
    using Value = typename std::decay_t<decltype(view)>::non_const_value_type;
    const ParticleColumn* const column = column_of(row.name);
    if (row.start == Start::column && column != nullptr && column->framed != Framed::no)
      spread(view, components_of<Value>, fields.*column->values, part);
  };
  auto points = soil;
  for_each_field_of(spread_column, points);
  fields.history.resize(soil.history.columns);
  for (int k = 0; k < soil.history.columns; ++k) spread(soil.history.column[k], 1, fields.history[k], part);
  const auto bodies = mirror_of(soil.bodies);
  const auto of_body = [&](int b, int) { return double(bodies(b).mass); };
  if (!soil.has_own_mass) spread(soil.body, 1, fields.mass, of_body);

  const double spacing = s.spacing;
  const auto half_length = [&](const auto& cells, int d) { return double(cells[d]) * spacing; };
  if (soil.has_domain) spread(soil.half_length, Dim, fields.half_length, half_length);
  if (soil.splits) spread(soil.ancestor, 1, fields.ancestor, part);
  if (soil.has_flow) spread(soil.solid_volume, 1, fields.solid_volume, part);

  for (int k = 0; k < soil.face_count; ++k) {
    std::vector<double> area;
    spread(soil.faces[k], Dim, area, part);
    fields.load_area.resize(area.size());
    for (std::size_t n = 0; n < area.size(); ++n) fields.load_area[n] += area[n];
  }
  if (soil.has_periods) spread(soil.periods, Dim, fields.periods, part);

  const auto x_p = host_of(soil.coordinate);
  const auto cell = host_of(soil.cell);
  const auto origin = mirror_of(Kokkos::subview(s.patches.origin, Kokkos::make_pair(0, s.patches.slots)));
  for (const int p : by_id) {
    const Coord<Dim> from = origin(cell(p) / Patch<Dim>::cells), in = coord_of<Dim>(cell(p));
    for (int d = 0; d < Dim; ++d) {
      double cells = double(from[d] + in[d]) + double(x_p(p)[d]);
      if (const int period = s.grid.period[d]; period > 0 && (cells < 0 || cells >= period)) {
        const int way = cells < 0 ? 1 : -1;  // back into the mesh
        cells += way * period;
        fields.periods[fields.position.size()] -= way;
      }
      fields.position.push_back(cells * s.spacing);
    }
  }
  return fields;
}

template <class Space, class T, int Dim>
std::vector<double> download_rigid_positions(const ContactCore<Space, T, Dim>& s, int rigid) {
  const auto& points = s.rigid_points[rigid].points;
  const auto reference_position = mirror_of(points.reference_position);
  const auto id = mirror_of(points.id);
  const auto rigids = mirror_of(s.rigids);
  std::vector<double> position(std::size_t(points.all) * Dim);
  for (int p = 0; p < points.all; ++p) {
    Vector<double, Dim> x = reference_position(p);
    for (int d = 0; d < Dim; ++d) x[d] *= s.spacing;
    x = rigids(rigid).motion.pose.to_world(x);
    for (int d = 0; d < Dim; ++d) position[std::size_t(id(p)) * Dim + d] = x[d];
  }
  return position;
}

template <class Space, class T, int Dim>
std::vector<Rigid<Dim>> take_rigids(ContactCore<Space, T, Dim>& s) {
  auto host = mirror_of(s.rigids);
  std::vector<Rigid<Dim>> rigids(host.data(), host.data() + host.extent(0));
  const auto view = s.rigids;
  Kokkos::parallel_for(
      "mpm::take_impulse", Kokkos::RangePolicy<Space>(s.space, 0, view.extent(0)),
      KOKKOS_LAMBDA(int r) { view(r).impulse = Wrench<Dim>{}; });
  return rigids;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                           \
  template std::vector<int> order_for_host(const ContactCore<Space, T, Dim>&);                   \
  template SoilFields download_soil(const ContactCore<Space, T, Dim>&);                          \
  template std::vector<double> download_rigid_positions(const ContactCore<Space, T, Dim>&, int); \
  template std::vector<Rigid<Dim>> take_rigids(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
