// Steps of a State in tests, and its fields on the host, compiled once for every build.

#include "compare.hpp"

namespace mpm::test {

template <class Space, class T, int Dim>
void interpolate(State<Space, T, Dim>& s) {
  reset_nodes(s);
  rigids_to_nodes(s, s.space);
  soil_to_nodes(s, s.space);
}

template <class Space, class T, int Dim>
void one_step(State<Space, T, Dim>& s, double dt) {
  Timers timers;
  timers.sample(false);
  if (timers.create() != PETSC_SUCCESS || step(s, timers, dt) != PETSC_SUCCESS)
    throw std::runtime_error("a step failed");
}

template <class Space, class T, int Dim>
int run_steps(State<Space, T, Dim>& s, double dt, int n) {
  int rebuilds = 0;
  for (; n > 0; --n) {
    one_step(s, dt);
    const Control control = read_control(s);
    if (control.fault_count > 0) return rebuilds;
    if (control.paused) rebuild(s), ++rebuilds;
  }
  return rebuilds;
}

template <class Space, class T, int Dim>
std::vector<Table> nodal_fields(const State<Space, T, Dim>& s) {
  std::vector<Table> fields{nodes_of(s, s.nodes.soil)};
  for (std::size_t r = 0; r < s.rigid_points.size() && s.mass_normals; ++r)
    fields.push_back(nodes_of(s, rigid_field(s, r)));
  if (s.soil_boundary) fields.push_back(nodes_of(s, s.nodes.boundary));
  return fields;
}

template <class Space, class T, int Dim>
std::vector<Table> soil_fields(const State<Space, T, Dim>& s) {
  SoilFields soil = download_soil(s);
  for (double& x : soil.position) x /= s.spacing;
  return {{Dim, soil.position}, {Dim, soil.velocity}, {sym_size<Dim>, soil.stress}, {1, soil.volume}};
}

double drift_of(int id, int d, double margin) {
  std::uint32_t h = (id * 3u + d) * 2654435761u;
  h = (h ^ (h >> 15)) * 2246822519u;
  h ^= h >> 13;
  if (h % 4 == 0) return margin;
  if (h % 4 == 1) return -margin;
  return margin * ((h >> 8) * 0x1p-23 - 1);
}
template <class T, int Dim, class Points_>
void drift(const Points_& points, double margin) {
  const auto x = on_host(points.coordinate);
  const auto id = on_host(points.id);
  for (int p = 0; p < points.count; ++p)
    for (int d = 0; d < Dim; ++d) x(p)[d] += static_cast<T>(drift_of(id(p), d, margin));
  Kokkos::deep_copy(points.coordinate, x);
}

template <class Space, class T, int Dim>
void drift_within_margin(State<Space, T, Dim>& s) {
  drift<T, Dim>(s.soil.points, s.p2g.margin);
  const auto origin = on_host(s.patches.origin);
  const auto rigids = on_host(s.rigids);
  for (std::size_t r = 0; r < s.rigid_points.size(); ++r) {
    const auto& points = s.rigid_points[r].points;
    drift<T, Dim>(points, s.p2g.margin);
    // Their homes go with them: a strategy may bring a point to where its body is.
    const auto coordinate = on_host(points.coordinate);
    const auto cell = on_host(points.cell);
    const auto home = on_host(points.reference_position);
    for (int p = 0; p < points.count; ++p)
      for (int d = 0; d < Dim; ++d)
        home(p)[d] = coordinate(p)[d] + origin(cell(p) / Patch<Dim>::cells)[d] + coord_of<Dim>(cell(p))[d] -
                     rigids(r).motion.pose.displacement[d] / s.spacing;
    Kokkos::deep_copy(points.reference_position, home);
  }
}

double largest_difference(const Table& got, const Table& expected) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (got.width != expected.width || got.value.size() != expected.value.size()) return infinite;
  double largest = 0;
  for (int k = 0; k < expected.width; ++k) {
    double difference = 0, scale = 0;
    for (std::size_t n = k; n < expected.value.size(); n += expected.width) {
      if (!std::isfinite(got.value[n]) || !std::isfinite(expected.value[n])) return infinite;
      difference = std::max(difference, std::fabs(got.value[n] - expected.value[n]));
      scale = std::max(scale, std::fabs(expected.value[n]));
    }
    if (difference > 0) largest = std::max(largest, difference / scale);
  }
  return largest;
}
double largest_difference(const std::vector<Table>& got, const std::vector<Table>& expected) {
  double largest = got.size() == expected.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < std::min(got.size(), expected.size()); ++n)
    largest = std::max(largest, largest_difference(got[n], expected[n]));
  return largest;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                   \
  template void interpolate(State<Space, T, Dim>&);                      \
  template void one_step(State<Space, T, Dim>&, double);                 \
  template int run_steps(State<Space, T, Dim>&, double, int);            \
  template std::vector<Table> nodal_fields(const State<Space, T, Dim>&); \
  template std::vector<Table> soil_fields(const State<Space, T, Dim>&);  \
  template void drift_within_margin(State<Space, T, Dim>&);
MPM_FOR_TESTED(MPM_INSTANTIATE)
#undef MPM_INSTANTIATE

}  // namespace mpm::test
