#pragma once
// Steps of a State in tests, and its fields on the host in an order that no backend or strategy changes.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "clouds.hpp"
#include "functions/energy_works.hpp"
#include "functions/find_strays.hpp"
#include "functions/split_patches.hpp"
#include "functions/surface_loads.hpp"
#include "functions/velocity_update.hpp"
#include "loops/interpolation.hpp"
#include "rebuild/batches.hpp"
#include "step/step.hpp"

namespace mpm::test {

template <class View>
auto on_host(const View& view) {
  return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
}

/// The nodal field of one rigid.
template <class Space, class T, int Dim>
NodeField<Space, T, RigidTerms<Dim>::size> rigid_field(const State<Space, T, Dim>& s, std::size_t r) {
  return Kokkos::subview(s.nodes.rigid, static_cast<int>(r), Kokkos::ALL, Kokkos::ALL);
}

/// Functions 1 to 3 of a step.
template <class Space, class T, int Dim>
void interpolate(State<Space, T, Dim>& s);

/// One step, without timing it.
template <class Space, class T, int Dim>
void one_step(State<Space, T, Dim>& s, double dt);

/// n steps, with a rebuild whenever the movement bound asks for it. Stops at a fault. Returns the rebuilds.
template <class Space, class T, int Dim>
int run_steps(State<Space, T, Dim>& s, double dt, int n);

/// Momentum of soil particles and rigids.
template <class Space, class T, int Dim>
Vector<double, Dim> total_momentum(const State<Space, T, Dim>& s) {
  const auto velocity = on_host(s.soil.points.velocity);
  const auto body = on_host(s.soil.points.body);
  const auto bodies = on_host(s.soil.points.bodies);
  const auto rigids = on_host(s.rigids);
  auto sum = filled<double, Dim>(0);
  for (int d = 0; d < Dim; ++d) {
    for (int p = 0; p < s.soil.points.count; ++p) sum[d] += double(bodies(body(p)).mass) * velocity(p)[d];
    for (std::size_t r = 0; r < rigids.extent(0); ++r)
      sum[d] += rigids(r).inertia.mass * rigids(r).motion.velocity[d];
  }
  return sum;
}

/// Values by place: of node i of the whole grid of patches, or of particle id.
struct Table {
  int width = 0;
  std::vector<double> value;
  friend bool operator==(const Table&, const Table&) = default;
};

/// A nodal field by the node's address in the whole grid; zero where no patch is active.
template <class Space, class T, int Dim, class Field>
Table nodes_of(const State<Space, T, Dim>& s, const Field& field) {
  const auto host = on_host(field);
  const auto number = on_host(s.patches.number);
  Table table{static_cast<int>(field.extent(1)), {}};
  table.value.resize(s.grid.patch_count() * Patch<Dim>::cells * table.width);
  for (int i = 0; i < s.patches.node_count(); ++i) {
    const long at = address_of_node<Dim>(number, i);
    for (int k = 0; k < table.width; ++k) table.value[at * table.width + k] = host(i, k);
  }
  return table;
}

/// Every nodal field that particles give: the soil's, each rigid's, the volume.
template <class Space, class T, int Dim>
std::vector<Table> nodal_fields(const State<Space, T, Dim>& s);

/// A mesh of 6 cells of 1 m in each direction.
template <int Dim>
Grid<double, Dim> small_grid(Wall wall) {
  Grid<double, Dim> grid{};
  grid.spacing = grid.inv_spacing = 1;
  for (int d = 0; d < Dim; ++d) {
    grid.cells[d] = 6;
    grid.wall[d][0] = grid.wall[d][1] = wall;
  }
  return grid;
}

inline double component(double value, int) { return value; }
template <class T, int Dim>
double component(const Vector<T, Dim>& value, int k) {
  return value[k];
}
template <class T, int Dim>
double component(const SymTensor<T, Dim>& value, int k) {
  return value[k];
}

template <class T, int Dim>
double component(const Matrix<T, Dim>& value, int k) {
  return value[k];
}

template <class T, int Dim>
double component(const DomainMoments<T, Dim>& value, int k) {
  return value[k];
}

/// A field of points by id.
template <class Points_, class Field>
Table by_id(const Points_& points, const Field& field) {
  using Value = typename Field::value_type;
  const auto host = on_host(field);
  const auto id = on_host(points.id);
  Table table{1, {}};
  if constexpr (!std::is_arithmetic_v<Value>) table.width = sizeof(Value) / sizeof(std::declval<Value>()[0]);
  table.value.resize(std::size_t(points.count) * table.width);
  for (int p = 0; p < points.count; ++p)
    for (int k = 0; k < table.width; ++k)
      table.value[std::size_t(id(p)) * table.width + k] = component(host(p), k);
  return table;
}

/// Every field of for_each_field, by id.
template <class Points_>
std::vector<Table> carried_fields(Points_ points) {
  std::vector<Table> fields;
  for_each_field_of(
      [&](const ParticleField& row, const auto& field) {
        if (row.name != std::string("coordinate")) fields.push_back(by_id(points, field));
      },
      points);
  return fields;
}

/// Positions [cells], velocities and stresses of the soil, by id.
template <class Space, class T, int Dim>
std::vector<Table> soil_fields(const State<Space, T, Dim>& s);

/// Largest difference of two tables over the largest value of its column; infinite where either is not
/// finite.
double largest_difference(const Table& got, const Table& expected);

double largest_difference(const std::vector<Table>& got, const std::vector<Table>& expected);

/// Displacement [cells] of point `id` along d, any within the margin; for many points exactly it, up or down.
double drift_of(int id, int d, double margin);

/// Moves every point, soil and rigid, by drift_of. Bins and lists stay as they are.
template <class Space, class T, int Dim>
void drift_within_margin(State<Space, T, Dim>& s);

}  // namespace mpm::test
