// The surfaces of rigid bodies, and the soil's boundary at the nodes.

#include <catch2/catch_test_macros.hpp>

#include <numbers>

#include "compare.hpp"
#include "input/geometry/height_surface.hpp"
#include "loops/window.hpp"
#include "physics/contact.hpp"
#include "physics/surface.hpp"
#include "step/surface_input.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

MeshConfig mesh_of() {
  MeshConfig mesh;
  mesh.lower = {-5, -5, -5}, mesh.upper = {5, 5, 5}, mesh.spacing = 0.1, mesh.cells = {100, 100, 100};
  return mesh;
}

/// Signed distance of a shape at x [m], by way of what a run uploads.
template <int Dim>
Distance<Dim> distance(const Shape& shape, Vector<double, Dim> x, const MeshConfig& mesh = mesh_of()) {
  const SurfaceInput in = surface_input(shape, mesh, Dim);
  Surface<Dim> surface = surface_of<Dim>(in, mesh.spacing);
  const Kokkos::View<const Vertex*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> vertices(in.vertices.data(),
                                                                                         in.vertices.size());
  for (int d = 0; d < Dim; ++d) x[d] -= mesh.lower[d];
  return distance_to(surface, vertices, x);
}

Shape box(Vec3 lower, Vec3 upper, double fillet = 0, double angle = 0) {
  Shape shape;
  shape.lower = lower, shape.upper = upper, shape.fillet = fillet, shape.angle = angle;
  return shape;
}

Shape polygon(std::vector<std::array<double, 2>> vertices) {
  Shape shape;
  shape.kind = ShapeKind::polygon, shape.polygon = std::move(vertices), shape.width = {-1, 2};
  return shape;
}

template <int Dim>
bool is(const Distance<Dim>& got, double value, Vector<double, Dim> normal, double allowed = 1e-12) {
  double off = std::fabs(got.value - value);
  for (int d = 0; d < Dim; ++d) off += std::fabs(got.normal[d] - normal[d]);
  return off < allowed;
}

const double k_half = std::sqrt(0.5);
constexpr double k_round = 0.05;  // m, half a cell, by which corners are rounded

/// A box [cells] with normals of its own surface.
template <int Dim>
RigidInput plate_of(const std::array<double, 3>& from, const std::array<double, 3>& to, double spacing) {
  RigidInput plate = rigid_of<Dim>(lattice<Dim>(from, to, 4, spacing), 4, spacing);
  plate.surface_normal = true;
  for (int d = 0; d < 3; ++d) {
    plate.surface.half[d] = (to[d] - from[d]) * spacing / 2;
    plate.surface.centre[d] = (to[d] + from[d]) * spacing / 2;
  }
  return plate;
}

}  // namespace

TEST_CASE("distance to a layer of rasters: a plane, and a slope that curves", "[surface]") {
  const auto ground = [](auto&& height) {
    std::vector<double> lines, heights;
    for (int k = 0; k <= 40; ++k) lines.push_back(-6 + 0.3 * k);
    for (const double y : lines)
      for (const double x : lines) heights.push_back(height(x, y));
    Shape shape;
    shape.kind = ShapeKind::layer;
    shape.top = std::make_shared<const HeightSurface>(lines, lines, heights);
    shape.base = std::make_shared<const HeightSurface>(-5.0);
    return shape;
  };
  const Shape plane = ground([](double x, double y) { return 0.5 * x - 0.25 * y; });
  const double up = 1 / std::sqrt(1 + 0.25 + 0.0625);
  CHECK(is<3>(distance<3>(plane, {1.23, 0.4, 0.9}), (0.9 - 0.615 + 0.1) * up, {-0.5 * up, 0.25 * up, up}));
  CHECK(is<3>(distance<3>(plane, {-2, 1, -4}), (-4 + 1 + 0.25) * up, {-0.5 * up, 0.25 * up, up}));
  // A wide ball from above: the distance to its surface, near it.
  const Shape ball = ground([](double x, double y) { return std::sqrt(400 - x * x - y * y) - 19; });
  for (const double x : {-2.0, 0.0, 1.5})
    for (const double z : {-0.2, 0.1, 0.3}) {
      const double r = std::sqrt(x * x + 1 + std::pow(std::sqrt(399 - x * x) + z, 2));
      const auto got = distance<3>(ball, {x, 1, std::sqrt(399 - x * x) - 19 + z});
      CHECK(std::fabs(got.value - (r - 20)) < 3e-3);
      CHECK(std::fabs(got.normal[0] - x / r) < 5e-3);
    }
}

TEST_CASE("a layer between levels and polylines has the distance of its polygon", "[surface]") {
  Shape layer;
  layer.kind = ShapeKind::layer;
  layer.top = std::make_shared<const HeightSurface>(std::vector<double>{-6, 0, 7}, std::vector<double>{},
                                                    std::vector<double>{1, 1, 4.5});
  layer.base = std::make_shared<const HeightSurface>(-5.0);
  CHECK(is<2>(distance<2>(layer, {-2, 1.5}), 0.5, {0, 1}));
  CHECK(is<2>(distance<2>(layer, {-2, 0.5}), -0.5, {0, 1}));
  CHECK(is<2>(distance<2>(layer, {-2, -5}), -6, {0, 1}));  // the base is the mesh's side, no surface
  const double n = 1 / std::sqrt(1.25);
  CHECK(is<2>(distance<2>(layer, {2 - 0.5 * n, 2 + n}), 1, {-0.5 * n, n}));
  CHECK(is<3>(distance<3>(layer, {2 - 0.5 * n, 3, 2 + n}), 1, {-0.5 * n, 0, n}));
}

TEST_CASE("distance to a box: faces, rounded corners, inside, turned, cut off by the mesh", "[surface]") {
  const Shape plate = box({-2, 0}, {1, 1});
  CHECK(is<2>(distance<2>(plate, {0, -0.3}), 0.3, {0, -1}));
  CHECK(is<2>(distance<2>(plate, {1.2, 0.5}), 0.2, {1, 0}));
  CHECK(is<2>(distance<2>(plate, {0, 0.1}), -0.1, {0, -1}));
  CHECK(is<2>(distance<2>(plate, {0.95, 0.5}), -0.05, {1, 0}));
  // a corner is rounded by half a cell: its centre of curvature is 0.05 m inside
  CHECK(is<2>(distance<2>(plate, {1, 0}), 0.05 * (std::sqrt(2.) - 1), {k_half, -k_half}));
  CHECK(is<2>(distance<2>(box({-2, 0}, {1, 1}, 0.4), {1, 0}), 0.4 * (std::sqrt(2.) - 1), {k_half, -k_half}));
  // a quarter of a turn puts the box [0, 3] x [0, 1] onto [-1, 0] x [0, 3]
  CHECK(is<2>(distance<2>(box({0, 0}, {3, 1}, 0, std::numbers::pi / 2), {-0.5, 3.25}), 0.25, {0, 1}));
  CHECK(is<2>(distance<2>(box({0, 0}, {3, 1}, 0, std::numbers::pi / 4), {1, 1 - std::sqrt(0.5)}), 0.5,
              {k_half, -k_half}));
  // its left face is the mesh's side: no surface, and no corner
  const Shape half = box({-5, 0}, {1, 1});
  CHECK(is<2>(distance<2>(half, {-5, -0.3}), 0.3, {0, -1}));
  CHECK(is<2>(distance<2>(half, {-4.99, 0.4}), -0.4, {0, -1}));
  CHECK(is<3>(distance<3>(box({0, 0, 0}, {1, 1, 1}), {0.5, 0.5, 1.5}), 0.5, {0, 0, 1}));
  CHECK(is<3>(distance<3>(box({0, 0, 0}, {1, 1, 1}, 0, std::numbers::pi / 2), {-0.5, 0.5, 1.5}), 0.5,
              {0, 0, 1}));
}

TEST_CASE("distance to a disc, a half plane, a polygon and a prism", "[surface]") {
  Shape disc;
  disc.kind = ShapeKind::disc, disc.centre = {1, 2, 3}, disc.radius = 0.5;
  CHECK(is<2>(distance<2>(disc, {1, 3}), 0.5, {0, 1}));
  CHECK(is<3>(distance<3>(disc, {0.75, 2, 3}), -0.25, {-1, 0, 0}));
  Shape plane;
  plane.kind = ShapeKind::half_plane, plane.point = {1, 1, 0}, plane.normal = {0.6, 0.8, 0};
  CHECK(is<2>(distance<2>(plane, {1.6, 1.8}), 1, {0.6, 0.8}));
  CHECK(is<3>(distance<3>(plane, {0.4, 0.2, 2}), -1, {0.6, 0.8, 0}));
  for (const bool reversed : {false, true}) {
    std::vector<std::array<double, 2>> corner = {{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {0, 1}};
    if (reversed) std::reverse(corner.begin(), corner.end());
    const Shape ell = polygon(corner);
    CHECK(is<2>(distance<2>(ell, {0.5, -0.5}), 0.5, {0, -1}));
    CHECK(is<2>(distance<2>(ell, {0.5, 1.25}), 0.25, {0, 1}));
    CHECK(is<2>(distance<2>(ell, {1.75, 1}), -0.25, {1, 0}));
    CHECK(is<2>(distance<2>(ell, {2.25, 2.35}), 0.5 - k_round, {0.6, 0.8}));  // its corner is rounded
    CHECK(is<2>(distance<2>(ell, {0.3, 1.5}), 0.5, {0, 1}));
    CHECK(is<2>(distance<2>(ell, {0.9, 1.1}), 0.1, {-k_half, k_half}));  // one that points into it is not
    CHECK(is<2>(distance<2>(ell, {0.5, 0}), 0, {0, -1}));
    CHECK(is<3>(distance<3>(ell, {0.5, 0, -0.5}), 0.5, {0, 0, -1}));
    CHECK(is<3>(distance<3>(ell, {0.5, 2.5, 0.5}), 0.5, {0, 1, 0}));
    CHECK(is<3>(distance<3>(ell, {0.5, -1.25, -0.35}), 0.5 - k_round, {0, -0.6, -0.8}));
  }
  // an edge on the mesh's side is no surface
  CHECK(distance<2>(polygon({{-5, -5}, {5, -5}, {5, 0}, {-5, 0}}), {-4.9, -4}).value == -4);
}

TEST_CASE("the soil's boundary sums to the area of each face, wherever the block lies", "[surface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double spacing = 0.1;
    Dice dice{std::mt19937_64(7)};
    for (int trial = 0; trial < 4; ++trial) {
      std::array<double, 3> low{}, high{};
      for (int d = 0; d < 3; ++d) {
        low[d] = 4 + dice.uniform(0, 1);
        high[d] = low[d] + 3 + 0.5 * dice.below(4);
      }
      Cloud cloud;
      cloud.grid = grid_of<Dim>({16, 16, 16}, spacing, Wall::free);
      cloud.materials = clays();
      cloud.bodies = {body_of<Dim>(lattice<Dim>(low, high, 2, spacing), 2, spacing, 1)};
      cloud.rigids = {rigid_of<Dim>(lattice<Dim>({0, 0, 0}, {16, 16, 16}, 1, spacing), 1, spacing)};
      cloud.rigids[0].surface_normal = true;
      for (int d = 0; d < 3; ++d)
        cloud.rigids[0].surface.half[d] = cloud.rigids[0].surface.centre[d] = 8 * spacing;
      for (P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        interpolate(s);
        const Table field = nodes_of(s, s.nodes.boundary);
        double face = 1, lower = 0, upper = 0, across = 0;
        for (int d = 0; d < Dim - 1; ++d) face *= (high[d] - low[d]) * spacing;
        for (int z = 0; z <= 16; ++z)
          for (int y = 0; y <= 16; ++y)
            for (int x = 0; x <= (Dim == 3 ? 16 : 0); ++x) {
              Coord<Dim> node{y, z};
              if constexpr (Dim == 3) node = {x, y, z};
              const double* a = &field.value[s.grid.address_of(node) * field.width];
              (z < (low[Dim - 1] + high[Dim - 1]) / 2 ? lower : upper) += a[Dim - 1];
              across += std::fabs(a[0]) > 0 ? a[0] : 0;
            }
        INFO(build.name() << ' ' << word_of(how));
        CHECK(std::fabs(lower + face) < B::of(1e-12, 1e-5) * face);
        CHECK(std::fabs(upper - face) < B::of(1e-12, 1e-5) * face);
        CHECK(std::fabs(across) < B::of(1e-12, 1e-5) * face);
      }
    }
  });
}

TEST_CASE("soil pressed into a thin plate is stopped by the face that it is at", "[surface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double spacing = 0.1;
    for (const bool below : {true, false}) {
      Cloud cloud;
      cloud.grid = grid_of<Dim>({20, 20, 20}, spacing, Wall::free);
      cloud.materials = clays();
      // 0.6 of the plate deep in it, so that the nodes at its far side hold soil too
      const double face = below ? 10.6 : 10.4;
      std::array<double, 3> low{6, 6, 6}, high{14, 14, 14};
      (below ? high : low)[Dim - 1] = face;
      cloud.bodies = {body_of<Dim>(lattice<Dim>(low, high, 5, spacing), 5, spacing, 1)};
      cloud.bodies[0].common_velocity[Dim - 1] = below ? 1 : -1;
      std::array<double, 3> from{4, 4, 4}, to{16, 16, 16};
      from[Dim - 1] = 10, to[Dim - 1] = 11;
      cloud.rigids = {plate_of<Dim>(from, to, spacing)};
      auto s = state_of<B>(cloud);
      interpolate(s);
      update_nodes(s, 1e-6);
      const Table motion = nodes_of(s, s.nodes.kinematics), soil = nodes_of(s, s.nodes.soil);
      double fastest = 0;
      int held = 0;
      for (int z : {10, 11}) {
        Coord<Dim> node{10, z};
        if constexpr (Dim == 3) node = {10, 10, z};
        const std::size_t at = s.grid.address_of(node);
        held += soil.value[at * soil.width] > s.scheme.mass_cut;
        fastest = std::max(fastest, std::fabs(motion.value[at * motion.width + Dim - 1]));
      }
      INFO(build.name() << (below ? " soil below" : " soil above"));
      CHECK(held == 2);
      CHECK(fastest < B::of(1e-12, 1e-5));
    }
  });
}

TEST_CASE("a surface is the same in any unit of length", "[surface]") {
  for (const double unit : {1e-9, 1e-6, 1e3}) {
    const auto scaled = [&](Vec3 x) { return Vec3{unit * x[0], unit * x[1], unit * x[2]}; };
    MeshConfig mesh = mesh_of();
    mesh.lower = scaled(mesh.lower), mesh.upper = scaled(mesh.upper), mesh.spacing *= unit;
    const std::vector<std::array<double, 2>> outline{{0, 0}, {2, 0}, {2, 1}, {0, 1}};
    std::vector<std::array<double, 2>> small = outline;
    for (auto& vertex : small) vertex[0] *= unit, vertex[1] *= unit;
    for (const double x : {-0.4, -0.03, 0.03, 0.4, 1.3, 1.97, 2.03})
      for (const double y : {-0.03, 0.03, 0.45, 0.97, 1.03}) {
        const Distance<2> of_box = distance<2>(box({0, 0}, {2, 1}), {x, y});
        const Distance<2> in_unit = distance<2>(box({0, 0}, scaled({2, 1})), {unit * x, unit * y}, mesh);
        CHECK(is<2>({in_unit.value / unit, in_unit.normal}, of_box.value, of_box.normal));
        const Distance<2> of_outline = distance<2>(polygon(outline), {x, y});
        const Distance<2> small_one = distance<2>(polygon(small), {unit * x, unit * y}, mesh);
        CHECK(is<2>({small_one.value / unit, small_one.normal}, of_outline.value, of_outline.normal));
      }
  }
}

TEST_CASE("round-off does not choose the face at an edge or a vertex of a surface", "[surface]") {
  const Shape square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  for (const double a : {-1e-13, 0., 1e-13})
    for (const double b : {-1e-13, 0., 1e-13}) {
      CHECK(
          is<2>(distance<2>(square, {1 + a, 1 + b}), k_round * (std::sqrt(2.) - 1), {k_half, k_half}, 1e-11));
      CHECK(is<2>(distance<2>(square, {1 + a, 0.5 + b}), 0, {1, 0}));
      Vector<double, 2> n;
      distance_to_product<2>({a, b}, 0, 1e-10, n);
      CHECK((n[0] == 1 && n[1] == 0));
    }
}

TEST_CASE("where several faces are as near the normal is the sum of theirs, whatever round-off says",
          "[surface]") {
  const Shape square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), wedge = polygon({{0, 0}, {1, 2}, {-1, 2}});
  const Shape plate = polygon({{-0.1, 0}, {0.1, 0}, {0.1, 9}, {-0.1, 9}});
  for (const double a : {-1e-13, 0., 1e-13})
    for (const double b : {-1e-13, 0., 1e-13}) {
      CHECK(is<2>(distance<2>(square, {0.25 + a, 0.25 + b}), -0.25, {-k_half, -k_half}));
      CHECK(is<2>(distance<2>(wedge, {a, 1 + b}), -1 / std::sqrt(5.), {0, -1}));
      CHECK(is<2>(distance<2>(wedge, {a, b}), k_round, {0, -1}, 1e-11));  // a tip recedes by half a cell
      for (const Shape& shape : {plate, box({-0.1, 0, 0}, {0.1, 9, 0})})  // they cancel
        CHECK(is<2>(distance<2>(shape, {a, 4 + b}), -0.1, {0, 0}));
      CHECK(is<2>(distance<2>(box({0, 0, 0}, {1, 1, 0}), {0.75 + a, 0.25 + b}), -0.25, {0, 0}));
    }
  // Outside the normal is the sum of those of the faces; the way from a vertex of several edges is one.
  const Shape valley = polygon({{-2, -1}, {2, -1}, {2, 2}, {0, 0}, {-2, 2}});
  CHECK(is<2>(distance<2>(valley, {0, 1}), k_half, {0, 1}));
  const double radius = k_round / (1 / std::cos(3 * M_PI / 8) - 1);  // its sharp tips recede by half a cell
  CHECK(is<2>(distance<2>(valley, {0, -0.25}), -0.25 + radius * (std::sqrt(2.) - 1), {0, 1}, 1e-11));
}

TEST_CASE(
    "soil of which only a part is under a plate is pushed alike on both sides of their plane of symmetry",
    "[surface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if constexpr (B::dim == 3) {
      // The plate's corners lie above the soil's edges, and are at a right angle to the soil's boundary
      // there.
      const double spacing = 0.1;
      Cloud cloud;
      cloud.grid = grid_of<3>({20, 20, 20}, spacing, Wall::free);
      cloud.materials = clays();
      cloud.bodies = {body_of<3>(lattice<3>({6, 6, 6}, {14, 14, 10}, 2, spacing), 2, spacing, 1)};
      cloud.bodies[0].common_velocity[2] = 1;
      cloud.rigids = {plate_of<3>({10, 6, 10}, {16, 14, 12}, spacing)};
      cloud.rigids[0].surface.radius = spacing / 2;
      for (P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        interpolate(s);
        update_nodes(s, 1e-6);
        const Table motion = nodes_of(s, s.nodes.kinematics);
        double apart = 0, slowest = 1;
        for (int x = 5; x <= 15; ++x)
          for (int y = 5; y < 10; ++y)
            for (int d = 0; d < 3; ++d) {
              const auto v = [&](int y) {
                return motion.value[s.grid.address_of({x, y, 10}) * motion.width + d];
              };
              apart = std::max(apart, std::fabs(v(y) - (d == 1 ? -1 : 1) * v(20 - y)));
              if (d == 2 && x < 14 && y > 6) slowest = std::min(slowest, std::fabs(v(y)));
            }
        INFO(build.name() << ' ' << word_of(how));
        CHECK(apart < B::of(1e-12, 1e-5));
        CHECK(slowest < B::of(1e-12, 1e-5));
      }
    }
  });
}

TEST_CASE("a patch counts as near a rigid if its particles reach a node that the rigid may touch",
          "[surface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double spacing = 0.1, margin = 0.5;
    int left_out = 0;
    for (const double low : {20.0, 20.7, 23.0, 26.5}) {
      Cloud cloud;
      cloud.grid = grid_of<Dim>({48, 48, 48}, spacing, Wall::free);
      cloud.materials = clays();
      cloud.bodies = {body_of<Dim>(lattice<Dim>({4, 4, 4}, {20, 44, 12}, 1, spacing), 1, spacing, 1)};
      std::array<double, 3> from{2, 2, 2}, to{24, 24, 14};
      from[Dim - 1] = low, to[Dim - 1] = low + 2;
      cloud.rigids = {plate_of<Dim>(from, to, spacing)};
      const auto s = state_of<B>(cloud);
      const auto near = on_host(s.contact.place), soil_begin = on_host(s.soil.bins.begin);
      const auto neighbours = on_host(s.patches.neighbours);
      const auto rigid_begin = on_host(s.rigid_points[0].bins.begin);
      const auto origin = on_host(s.patches.origin);
      constexpr int cells = Patch<Dim>::cells;
      for (int slot = 0; slot < s.patches.slots; ++slot) {
        if (near(slot) != 0 || soil_begin(slot * cells) == soil_begin((slot + 1) * cells)) continue;
        for (int k = 0; k < Patch<Dim>::neighbours; ++k) {
          const int other = neighbours(slot, k);
          left_out += other >= 0 && rigid_begin(other * cells) < rigid_begin((other + 1) * cells);
        }
        for (int n = 0; n < Patch<Dim>::window; ++n) {
          const Coord<Dim> at = window_coord<Dim>(n);
          Vector<double, Dim> x;
          for (int d = 0; d < Dim; ++d) x[d] = (origin(slot)[d] + at[d]) * spacing;
          const auto rigid = on_host(s.rigids)(0);
          CHECK(distance_to(rigid.surface, on_host(s.vertices.vertices), x).value >
                (std::sqrt(double(Dim)) + margin) * spacing);
        }
      }
    }
    INFO(build.name());
    CHECK((left_out > 0 || Dim == 3));  // patches of 4 cells: those around one lie within its reach
  });
}

TEST_CASE("the gap scaling is 1 in touch and 0 from its reach on", "[surface]") {
  CHECK(gap_scaling(-0.1, 0.5, 6.) == 1);
  CHECK(gap_scaling(0., 0.5, 6.) == 1);
  CHECK(std::fabs(gap_scaling(0.25, 0.5, 6.) - (1 - 1. / 64)) < 1e-15);
  CHECK(gap_scaling(0.5, 0.5, 6.) == 0);
}

TEST_CASE("soil begins where its volume and area at a node say, whatever part of the cells it covers",
          "[surface]") {
  for (const double covered : {1., 0.3})
    for (const double h : {-0.95, -0.5, -0.1, 0., 0.2, 0.7, 0.95}) {
      const double k = 1 - std::fabs(h), beyond = k * k / 2;
      CHECK(std::fabs(surface_depth(covered * (h > 0 ? beyond : 1 - beyond), covered * k) - h) < 1e-14);
    }
  CHECK(surface_depth(1., 0.) == -1);  // within soil
  CHECK(surface_depth(1., -0.1) == -1);
}

TEST_CASE("contact begins where the gap is closed, and the mass of the body does not matter", "[surface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double spacing = 0.1;
    for (const double gap : {0.3, 0.2, 0.1, 0., -0.2}) {  // cells
      Cloud cloud;
      cloud.grid = grid_of<Dim>({20, 20, 20}, spacing, Wall::free);
      cloud.materials = clays();
      std::array<double, 3> high{14, 14, 14};
      high[Dim - 1] = 10 - gap;
      cloud.bodies = {body_of<Dim>(lattice<Dim>({6, 6, 6}, high, 10, spacing), 10, spacing, 1)};
      cloud.bodies[0].common_velocity[Dim - 1] = 1;
      std::array<double, 3> from{4, 4, 4}, to{16, 16, 16};
      from[Dim - 1] = 10, to[Dim - 1] = 12;
      cloud.rigids = {plate_of<Dim>(from, to, spacing)};
      cloud.rigids[0].reach = 0.15 * spacing;
      auto s = state_of<B>(cloud);
      interpolate(s);
      update_nodes(s, 1e-6);
      const Table motion = nodes_of(s, s.nodes.kinematics);
      const auto speed = [&](int z) {
        Coord<Dim> node{10, z};
        if constexpr (Dim == 3) node = {10, 10, z};
        return motion.value[s.grid.address_of(node) * motion.width + Dim - 1];
      };
      INFO(build.name() << " gap " << gap);
      CHECK(std::fabs(speed(10) - (1 - gap_scaling(gap, 0.15, 6.))) < B::of(1e-10, 1e-3));
      CHECK(std::fabs(speed(9) - 1) < B::of(1e-10, 1e-4));  // within the soil
    }
  });
}
