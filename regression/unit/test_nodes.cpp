// At the nodes: velocities, accelerations and walls.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "physics/contact.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Velocity after the walls of a node that moves with (1, 2, 3).
template <int Dim>
Vector<double, Dim> walled(const Grid<double, Dim>& grid, Coord<Dim> node) {
  Vector<double, Dim> v;
  for (int d = 0; d < Dim; ++d) v[d] = d + 1;
  apply_walls(grid, sides_of(grid, node), v);
  return v;
}
bool equal(const Vector<double, 2>& v, double x, double y) { return v[0] == x && v[1] == y; }
bool equal(const Vector<double, 3>& v, double x, double y, double z) {
  return v[0] == x && v[1] == y && v[2] == z;
}

/// The state with mass 1, momentum (1, 2, 3) and no force at every node.
template <class B>
StateOf<B> nodes_that_move(const GridInput& grid) {
  Cloud cloud;
  cloud.grid = grid;
  cloud.materials = clays();
  const std::array<double, 3> end{double(grid.cells[0]), double(grid.cells[1]), double(grid.cells[2])};
  cloud.bodies = {body_of<B::dim>(lattice<B::dim>({0, 0, 0}, end, 1, grid.spacing), 1, grid.spacing, 0)};
  auto s = state_of<B>(cloud);
  const auto soil = on_host(s.nodes.soil);
  for (int i = 0; i < s.patches.node_count(); ++i)
    for (int k = 0; k < SoilTerms<B::dim>::size; ++k)
      soil(i, k) = k < SoilTerms<B::dim>::force ? std::max(1, k) : 0;
  Kokkos::deep_copy(s.nodes.soil, soil);
  return s;
}

/// Every node of a state, as (its place in the mesh, its velocity, its acceleration), checked by f; how often
/// it fails.
template <class Space, class T, int Dim, class F>
int wrong_nodes(const State<Space, T, Dim>& s, F&& right) {
  const auto motion = on_host(s.nodes.kinematics);
  const auto origin = on_host(s.patches.origin);
  int wrong = 0;
  for (int i = 0; i < s.patches.node_count(); ++i) {
    Coord<Dim> at = coord_of<Dim>(i);
    Vector<double, Dim> v, a;
    for (int d = 0; d < Dim; ++d) {
      at[d] += origin(i / Patch<Dim>::cells)[d];
      v[d] = motion(i, d);
      a[d] = motion(i, Dim + d);
    }
    wrong += !right(at, v, a);
  }
  return wrong;
}

}  // namespace

TEST_CASE("a roller stops the normal velocity at faces, edges and corners, and beyond them", "[nodes]") {
  const auto flat = small_grid<2>(Wall::roller);
  CHECK(equal(walled<2>(flat, {3, 3}), 1, 2));
  CHECK(equal(walled<2>(flat, {0, 3}), 0, 2));
  CHECK(equal(walled<2>(flat, {6, 3}), 0, 2));
  CHECK(equal(walled<2>(flat, {3, 6}), 1, 0));
  CHECK(equal(walled<2>(flat, {-1, 3}), 0, 2));
  CHECK(equal(walled<2>(flat, {7, -1}), 0, 0));
  CHECK(equal(walled<2>(flat, {5, 1}), 1, 2));
  const auto deep = small_grid<3>(Wall::roller);
  CHECK(equal(walled<3>(deep, {0, 3, 6}), 0, 2, 0));
  CHECK(equal(walled<3>(deep, {3, 7, 3}), 1, 0, 3));
  CHECK(equal(walled<3>(deep, {0, 0, 6}), 0, 0, 0));
}

TEST_CASE("a fixed wall stops every velocity, a free one none, and the stricter holds where two meet",
          "[nodes]") {
  const auto fixed = small_grid<2>(Wall::fixed), free = small_grid<2>(Wall::free);
  CHECK(equal(walled<2>(fixed, {0, 3}), 0, 0));
  CHECK(equal(walled<2>(fixed, {3, 7}), 0, 0));
  CHECK(equal(walled<2>(fixed, {3, 5}), 1, 2));
  CHECK(equal(walled<2>(free, {0, 6}), 1, 2));
  auto mixed = small_grid<2>(Wall::roller);  // the footing's box: rollers, fixed below, free on top
  mixed.wall[1][0] = Wall::fixed;
  mixed.wall[1][1] = Wall::free;
  CHECK(equal(walled<2>(mixed, {0, 0}), 0, 0));
  CHECK(equal(walled<2>(mixed, {3, 0}), 0, 0));
  CHECK(equal(walled<2>(mixed, {0, 3}), 0, 2));
  CHECK(equal(walled<2>(mixed, {0, 6}), 0, 2));
  CHECK(equal(walled<2>(mixed, {3, 6}), 1, 2));
}

TEST_CASE("every node of the mesh and of the ring round it obeys its walls", "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    constexpr Wall kinds[] = {Wall::roller, Wall::fixed, Wall::free};
    for (int first = 0; first < 3; ++first) {
      GridInput grid = grid_of<Dim>({9, 11, 6}, 0.1, Wall::free);
      for (int d = 0; d < Dim; ++d)
        for (int side = 0; side < 2; ++side) grid.walls[d][side] = kinds[(first + d + side) % 3];
      auto s = nodes_that_move<B>(grid);
      const double dt = 0.25;
      update_nodes(s, dt);
      INFO(build.name() << " walls " << first);
      CHECK(wrong_nodes(
                s, [&](const Coord<Dim>& at, const Vector<double, Dim>& v, const Vector<double, Dim>& a) {
                  bool stopped[3] = {}, held = false;
                  for (int d = 0; d < Dim; ++d)
                    for (int side = 0; side < 2; ++side) {
                      if (side == 0 ? at[d] > 0 : at[d] < grid.cells[d]) continue;
                      held = held || grid.walls[d][side] == Wall::fixed;
                      stopped[d] = stopped[d] || grid.walls[d][side] == Wall::roller;
                    }
                  bool right = true;
                  for (int d = 0; d < Dim; ++d) {
                    const double expected = held || stopped[d] ? 0 : d + 1;
                    right = right && v[d] == expected && a[d] == (expected - (d + 1)) / dt;
                  }
                  return right;
                }) == 0);
    }
  });
}

TEST_CASE(
    "nodes without mass are at rest, those of hardly any feel no force, and force and gravity move the "
    "others",
    "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    using Terms = SoilTerms<Dim>;
    INFO(build.name());
    auto s = nodes_that_move<B>(grid_of<Dim>({9, 11, 6}, 0.1, Wall::free));
    s.gravity[1] = -8;
    const auto soil = on_host(s.nodes.soil);
    for (int i = 0; i < s.patches.node_count(); ++i) {
      soil(i, Terms::force) = 4;
      if (i % 3 == 0) soil(i, Terms::mass) = 0;
      if (i % 3 != 1) continue;
      const auto light = static_cast<typename B::real>(s.scheme.mass_cut / 2);
      soil(i, Terms::mass) = light;
      for (int d = 0; d < Dim; ++d) soil(i, Terms::momentum + d) = light * (d + 1);
    }
    Kokkos::deep_copy(s.nodes.soil, soil);
    update_nodes(s, 0.25);
    int n = 0;
    const auto motion = on_host(s.nodes.kinematics);
    for (int i = 0; i < s.patches.node_count(); ++i) {
      const double force = i % 3 == 2 ? 4 : 0, gravity = i % 3 == 0 ? 0 : -8;
      const double v[2] = {i % 3 == 0 ? 0 : 1 + 0.25 * force, i % 3 == 0 ? 0 : 2 + 0.25 * gravity};
      n += std::fabs(motion(i, 0) - v[0]) > 1e-5 || std::fabs(motion(i, 1) - v[1]) > 1e-5 ||
           std::fabs(motion(i, Dim) - force) > 1e-5 || std::fabs(motion(i, Dim + 1) - gravity) > 1e-5;
    }
    CHECK(n == 0);
  });
}

TEST_CASE("damping takes a fraction of the acceleration, against the velocity", "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    auto s = nodes_that_move<B>(grid_of<Dim>({9, 11, 6}, 0.1, Wall::free));
    s.scheme.damping = 0.25;
    const auto soil = on_host(s.nodes.soil);
    for (int i = 0; i < s.patches.node_count(); ++i)
      soil(i, SoilTerms<Dim>::force) = 4, soil(i, SoilTerms<Dim>::force + 1) = -4;
    soil(1, SoilTerms<Dim>::momentum) = 1e-8, soil(2, SoilTerms<Dim>::momentum) = -1e-8;
    Kokkos::deep_copy(s.nodes.soil, soil);
    update_nodes(s, 0.25);
    const auto motion = on_host(s.nodes.kinematics);
    CHECK(motion(0, Dim) == 3);       // speeding up: 4 - 1
    CHECK(motion(0, Dim + 1) == -5);  // slowing down: -4 - 1
    // A velocity that is round-off beside its change has no direction.
    for (const int i : {1, 2}) CHECK(std::fabs(motion(i, Dim) - 4) < 1e-5);
  });
}
