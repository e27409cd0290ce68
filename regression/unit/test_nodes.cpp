// At the nodes: walls, contact with rigids, and what their forces sum to.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "contact.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();

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

/// Velocity after the walls of a node that moves with (1, 2, 3).
template <int Dim>
Vector<double, Dim> walled(const Grid<double, Dim>& grid, Coord<Dim> node) {
  Vector<double, Dim> v;
  for (int d = 0; d < Dim; ++d) v[d] = d + 1;
  apply_walls(grid, sides_of(grid, node), v);
  return v;
}
bool equal(const Vector<double, 2>& v, double x, double y) { return v[0] == x && v[1] == y; }
bool equal(const Vector<double, 3>& v, double x, double y, double z) { return v[0] == x && v[1] == y && v[2] == z; }
bool near(const Vector<double, 2>& v, double x, double y) { return std::fabs(v[0] - x) + std::fabs(v[1] - y) < 1e-15; }

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
    for (int k = 0; k < SoilShare<B::dim>::size; ++k) soil(i, k) = k < SoilShare<B::dim>::force ? std::max(1, k) : 0;
  Kokkos::deep_copy(s.nodes.soil, soil);
  return s;
}

/// Every node of a state, as (its place in the mesh, its velocity, its acceleration), checked by f; how often it fails.
template <class Space, class T, int Dim, class F>
int wrong_nodes(const State<Space, T, Dim>& s, F&& right) {
  const auto motion = on_host(s.nodes.motion);
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

/// Soil and a rigid plate in one another, with velocities that press them together.
template <int Dim>
Cloud pressed() {
  const double spacing = 0.1;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({20, 18, 12}, spacing, Wall::free);
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({6, 5, 3}, {14, 9, 8}, 2, spacing), 2, spacing, 1)};
  cloud.bodies[0].velocity = {0.05, 0.2, -0.03};
  cloud.rigids = {rigid_of<Dim>(lattice<Dim>({8, 9, 4}, {12, 11, 7}, 4, spacing), 4, spacing)};
  cloud.rigids[0].velocity = {0.3, -0.5, 0.1};
  cloud.rigids[0].dynamic = true;
  cloud.rigids[0].shear_limit = 500;
  return cloud;
}

/// Momentum of the nodes' mass at their new velocity.
template <class Space, class T, int Dim>
Vector<double, Dim> nodal_momentum(const State<Space, T, Dim>& s) {
  const auto soil = on_host(s.nodes.soil);
  const auto motion = on_host(s.nodes.motion);
  auto sum = filled<double, Dim>(0);
  for (int i = 0; i < s.patches.node_count(); ++i)
    for (int d = 0; d < Dim; ++d) sum[d] += double(soil(i, 0)) * motion(i, d);
  return sum;
}

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
    for (std::size_t r = 0; r < rigids.extent(0); ++r) sum[d] += rigids(r).mass * rigids(r).velocity[d];
  }
  return sum;
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

TEST_CASE("a fixed wall stops every velocity, a free one none, and the stricter holds where two meet", "[nodes]") {
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
      CHECK(wrong_nodes(s, [&](const Coord<Dim>& at, const Vector<double, Dim>& v, const Vector<double, Dim>& a) {
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

TEST_CASE("nodes without mass are at rest, and force and gravity accelerate the others", "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    auto s = nodes_that_move<B>(grid_of<Dim>({9, 11, 6}, 0.1, Wall::free));
    s.gravity[1] = -8;
    const auto soil = on_host(s.nodes.soil);
    for (int i = 0; i < s.patches.node_count(); ++i) {
      soil(i, SoilShare<Dim>::force) = 4;
      if (i % 3 == 0) soil(i, 0) = static_cast<typename B::real>(s.mass_cut / 2);
    }
    Kokkos::deep_copy(s.nodes.soil, soil);
    update_nodes(s, 0.25);
    int n = 0;
    const auto motion = on_host(s.nodes.motion);
    for (int i = 0; i < s.patches.node_count(); ++i) {
      const bool none = i % 3 == 0;
      n += motion(i, 0) != (none ? 0 : 2) || motion(i, 1) != (none ? 0 : 0) || motion(i, Dim) != (none ? 0 : 4) ||
           motion(i, Dim + 1) != (none ? 0 : -8);
    }
    CHECK(n == 0);
    CHECK(on_host(s.sums)(0) == (Dim == 3 ? 3 : 2));  // the largest nodal speed
  });
}

TEST_CASE("damping takes a share of the acceleration, against the velocity", "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    auto s = nodes_that_move<B>(grid_of<Dim>({9, 11, 6}, 0.1, Wall::free));
    s.damping = 0.25;
    const auto soil = on_host(s.nodes.soil);
    for (int i = 0; i < s.patches.node_count(); ++i) soil(i, SoilShare<Dim>::force) = 4, soil(i, SoilShare<Dim>::force + 1) = -4;
    Kokkos::deep_copy(s.nodes.soil, soil);
    update_nodes(s, 0.25);
    const auto motion = on_host(s.nodes.motion);
    CHECK(motion(0, Dim) == 3);       // speeding up: 4 - 1
    CHECK(motion(0, Dim + 1) == -5);  // slowing down: -4 - 1
  });
}

TEST_CASE("contact: no pull, no penetration, and shear up to the lesser of its bounds", "[nodes]") {
  const Vector<double, 2> v{1, -2}, v_r{0, -0.5}, n{0, -1};  // relative (1, -1.5): approach 1.5, slip 1
  const auto change = [&](double shear_speed, double friction) {
    return contact_correction<double, 2>(v, v_r, n, {shear_speed, friction});
  };
  CHECK(near(change(0, -1), 0, 1.5));                // smooth
  CHECK(near(change(0.25, -1), -0.25, 1.5));         // limited
  CHECK(near(change(k_infinite, -1), -1, 1.5));      // rough: it sticks
  CHECK(near(change(3, -1), -1, 1.5));               // a limit above the slip does not reverse it
  CHECK(near(change(k_infinite, 0.4), -0.6, 1.5));   // friction
  CHECK(near(change(k_infinite, 0), 0, 1.5));
  CHECK(near(change(0.25, 0.4), -0.25, 1.5));        // both: the limit is less
  CHECK(near(change(0.8, 0.4), -0.6, 1.5));          // both: friction is less
  const Vector<double, 2> away{0, 1};
  CHECK(near(contact_correction<double, 2>(v, v_r, away, {k_infinite, -1}), 0, 0));             // they part
  CHECK(near(contact_correction<double, 2>({1, -0.5}, v_r, n, {k_infinite, -1}), 0, 0));        // they touch
  CHECK(near(contact_correction<double, 2>({0, -2}, v_r, n, {0.1, -1}), 0, 1.5));               // no slip
  const double r = std::sqrt(0.5);
  CHECK(near(contact_correction<double, 2>({2, 0}, {0, 0}, {r, r}, {0, -1}), -1, -1));           // an inclined face
  const auto in_3d = contact_correction<double, 3>({3, 4, 2}, {0, 0, 0}, {0, 0, 1}, {1, -1});   // slip (3, 4, 0)
  CHECK(std::fabs(in_3d[0] + 0.6) + std::fabs(in_3d[1] + 0.8) + std::fabs(in_3d[2] + 2) < 1e-15);
}

TEST_CASE("the inward normal is against the mass gradient, in a roller's plane, and none in the body", "[nodes]") {
  const auto grid = small_grid<2>(Wall::roller);
  Vector<double, 2> n{3, 4};
  REQUIRE(inward_normal(grid, 0u, 10.0, n));
  CHECK(near(n, -0.6, -0.8));
  n = {3, 4};  // on the plane x = 0 the mirrored half is missing
  REQUIRE(inward_normal(grid, sides_of<double, 2>(grid, {0, 3}), 10.0, n));
  CHECK(near(n, 0, -1));
  n = {3, 4};  // a fixed wall is no plane of symmetry
  REQUIRE(inward_normal(small_grid<2>(Wall::fixed), sides_of<double, 2>(grid, {0, 3}), 10.0, n));
  CHECK(near(n, -0.6, -0.8));
  n = {0.03, 0.03};  // less than a twentieth of the mass a cell's edge
  CHECK_FALSE(inward_normal(grid, 0u, 1.0, n));
  n = {0, 0.06};
  CHECK(inward_normal(grid, 0u, 1.0, n));
  n = {0, 0};
  CHECK_FALSE(inward_normal(grid, 0u, 0.0, n));
}

TEST_CASE("below a plate the mass gradient points down, out of it, and none counts in its middle", "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = pressed<Dim>();
    cloud.rigids = {rigid_of<Dim>(lattice<Dim>({4, 9, 2}, {14, 13, 9}, 4, 0.1), 4, 0.1)};
    auto s = state_of<B>(cloud);
    interpolate(s);
    const Table field = nodes_of(s, rigid_field(s, 0));
    const auto at = [&](Coord<Dim> node, int k) { return field.value[s.grid.address_of(node) * field.width + k]; };
    const auto node = [](int y) {
      Coord<Dim> c{9, y};
      if constexpr (Dim == 3) c[2] = 5;
      return c;
    };
    INFO(build.name());
    CHECK(at(node(9), 2) < -0.5 * at(node(9), 0));
    CHECK(std::fabs(at(node(9), 1)) < 1e-5 * at(node(9), 0));            // and not along it
    CHECK(std::fabs(at(node(11), 2)) < 1e-5 * at(node(11), 0));          // in its middle there is none
    CHECK(at(node(13), 2) > 0.5 * at(node(13), 0));                      // and up at its far face
  });
}

TEST_CASE("the force on a rigid is what the soil's momentum lost in the step", "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double dt = 1e-4;
    for (double shear_limit : {0., 500., k_infinite}) {
      Cloud cloud = pressed<Dim>();
      cloud.rigids[0].shear_limit = shear_limit;
      auto touching = state_of<B>(cloud);
      cloud.rigids.clear();
      auto alone = state_of<B>(cloud);
      for (auto* s : {&touching, &alone}) {
        interpolate(*s);
        update_nodes(*s, dt);
      }
      const auto with = nodal_momentum(touching), without = nodal_momentum(alone);
      const auto sums = on_host(touching.sums);
      INFO(build.name() << " shear limit " << shear_limit);
      CHECK(sums(2) > 0);                                         // the soil pushes the plate up
      CHECK(sums(1) < 0);                                         // and holds it back
      for (int d = 0; d < Dim; ++d)
        CHECK(std::fabs((without[d] - with[d]) / dt - sums(1 + d)) < B::of(1e-10, 1e-4) * sums(2));
    }
  });
}

TEST_CASE("soil and a rigid that hits it keep their momentum", "[nodes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (double shear_limit : {0., 500.}) {
      Cloud cloud = pressed<B::dim>();
      cloud.rigids[0].shear_limit = shear_limit;
      auto s = state_of<B>(cloud, P2G::tile);
      s.mass_cut = 0;  // a node that is left at rest for its small mass drops its force
      const auto before = total_momentum(s);
      const double rigid_before = on_host(s.rigids)(0).velocity[1];
      run_steps(s, 2e-4, 50);
      const auto after = total_momentum(s);
      INFO(build.name() << " shear limit " << shear_limit);
      CHECK(look(s).fault_count == 0);
      CHECK(on_host(s.rigids)(0).velocity[1] > rigid_before + 0.1);  // it was slowed down
      for (int d = 0; d < B::dim; ++d) CHECK(std::fabs(after[d] - before[d]) < B::of(1e-12, 1e-5) * std::fabs(before[1]));
    }
  });
}
