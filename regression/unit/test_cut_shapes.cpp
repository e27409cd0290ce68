// Shapes that planes of symmetry cut, cylinders and cones; filling tests no more places than it must.

#include <algorithm>
#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

#include "input/geometry/region.hpp"
#include "input/geometry/revolved.hpp"
#include "input/geometry/shapes.hpp"

using namespace mpm;
using Catch::Approx;

namespace {

constexpr double k_pi = std::numbers::pi;

MeshConfig mesh_of(Vec3 lower, Vec3 upper, double spacing) {
  MeshConfig mesh;
  mesh.lower = lower, mesh.upper = upper, mesh.spacing = spacing;
  return mesh;
}

Shape round_shape(ShapeKind kind, Vec3 centre, double radius, double height = 0, double tip = 0) {
  Shape shape;
  shape.kind = kind, shape.centre = centre, shape.radius = radius, shape.height = height,
  shape.tip_height = tip;
  return shape;
}

Shape cylinder(Vec3 centre, double radius, double height, double tip = 0) {
  return round_shape(ShapeKind::cylinder, centre, radius, height, tip);
}

Shape cone(Vec3 tip, double radius, double height, bool up) {
  Shape shape = round_shape(ShapeKind::cone, tip, radius, height);
  shape.tip_up = up;
  return shape;
}

Shape box(Vec3 lower, Vec3 upper, double fillet = 0) {
  Shape shape;
  shape.lower = lower, shape.upper = upper, shape.fillet = fillet;
  return shape;
}

Lattice filled(const Shape& shape, const MeshConfig& mesh, int dim) {
  Lattice lattice;
  REQUIRE(fill(shape, mesh, dim, lattice) == PETSC_SUCCESS);
  return lattice;
}

/// Volume of the particles over the shape's own in the mesh.
double share(const Shape& shape, const MeshConfig& mesh, int dim) {
  const Lattice lattice = filled(shape, mesh, dim);
  return lattice.position.size() / dim * lattice.particle_volume / lattice.shape_volume;
}

/// All points of the mesh's own lattice that a shape holds, or those of the cells that it holds.
std::vector<double> all_held(const Shape& shape, const MeshConfig& mesh, int dim) {
  Region region(shape, dim, 1e-9 * mesh.spacing);
  const int n = shape.fill == Fill::cell ? 1 : shape.particles_per_cell, ppc = shape.particles_per_cell / n;
  const double edge = mesh.spacing / n;
  std::array<long, 3> count{1, 1, 1};
  for (int d = 0; d < dim; ++d) count[d] = std::lround((mesh.upper[d] - mesh.lower[d]) / edge);
  std::vector<double> held;
  for (long c = 0; c < count[2]; ++c)
    for (long b = 0; b < count[1]; ++b)
      for (long a = 0; a < count[0]; ++a) {
        const std::array<long, 3> at{a, b, c};
        Vec3 corner{}, middle{};
        for (int d = 0; d < dim; ++d)
          corner[d] = mesh.lower[d] + at[d] * edge, middle[d] = corner[d] + edge / 2;
        region.enter_row(corner[dim - 1], corner[dim - 1] + edge);
        if (!(shape.fill == Fill::cell ? region.holds_cell(corner, edge) : region.holds(middle))) continue;
        for (int k = 0; k < (dim == 3 ? ppc : 1); ++k)
          for (int j = 0; j < ppc; ++j)
            for (int i = 0; i < ppc; ++i) {
              const std::array<int, 3> in{i, j, k};
              for (int d = 0; d < dim; ++d)
                held.push_back(mesh.lower[d] + (at[d] * ppc + in[d] + 0.5) * (edge / ppc));
            }
      }
  return held;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                            [](double x, double y) { return std::abs(x - y) < 1e-12; });
}

struct Dice {
  std::mt19937_64 engine;
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  }
};

/// Any shape but a box, which may reach beyond the mesh [-1, 2] x [0, 1.5] x [-1, 1].
Shape any_shape(Dice& dice, int dim) {
  const int kind = static_cast<int>(dice(0, dim == 2 ? 3 : 5));
  Shape shape;
  const Vec3 x{dice(-1, 2), dice(0, 1.5), dice(-1, 1)};
  if (kind == 0) {
    shape.kind = ShapeKind::half_plane, shape.point = x;
    shape.normal = {dice(-1, 1), dice(-1, 1), dim == 3 ? dice(-1, 1) : 0};
    if (dice(0, 1) < 0.3) shape.normal[0] = 0;
    if (dice(0, 1) < 0.3) shape.normal[0] *= 1e-9;
    const double length = std::hypot(shape.normal[0], shape.normal[1], shape.normal[2]);
    for (double& n : shape.normal) n /= length;
  } else if (kind == 1) {
    shape.kind = ShapeKind::polygon, shape.width = {0.2, 0.9};
    for (int k = 0; k < 12; ++k) {
      const double r = dice(0.1, 0.7), up = dim == 2 ? 0.75 : 0;
      shape.polygon.push_back({0.4 + r * std::cos(k * k_pi / 6), up + r * std::sin(k * k_pi / 6)});
    }
  } else if (kind == 2) {
    shape = round_shape(ShapeKind::disc, x, dice(0.05, 1));
  } else if (kind == 3) {
    const double height = dice(0.1, 1.5);
    shape = cylinder(x, dice(0.05, 1), height, dice(0, 1) < 0.5 ? 0 : height * dice(0, 1));
  } else {
    shape = cone(x, dice(0.05, 1), dice(0.1, 1.5), dice(0, 1) < 0.5);
  }
  if (dice(0, 1) < 0.3) shape.fill = Fill::cell;
  return shape;
}

}  // namespace

TEST_CASE("a shape has the particles of the mesh's lattice that it holds, and none beyond the mesh",
          "[shapes]") {
  Dice dice{std::mt19937_64(11)};
  for (int trial = 0; trial < 400; ++trial) {
    const int dim = 2 + trial % 2;
    const auto mesh = mesh_of({-1, 0, -1}, {2, 1.5, 1}, dim == 2 ? 0.05 : 0.125);
    const Shape shape = any_shape(dice, dim);
    if (!same(filled(shape, mesh, dim).position, all_held(shape, mesh, dim)))
      FAIL_CHECK("trial " << trial << ", kind " << int(shape.kind));
  }
}

TEST_CASE("a box that the mesh cuts has the particles of the box that ends there", "[shapes]") {
  const auto mesh = mesh_of({-1, 0, -1}, {2, 1.5, 1}, 0.1);
  for (int dim : {2, 3}) {
    const Shape cut = box({-7, -0.5, 0.03}, {0.22, 1.2, 5}), ends = box({-1, 0, 0.03}, {0.22, 1.2, 1});
    CHECK(filled(cut, mesh, dim).position == filled(ends, mesh, dim).position);
    CHECK(shape_volume(cut, mesh, dim) == Approx(shape_volume(ends, mesh, dim)));
  }
  // its other corners stay rounded
  const Shape round = box({-3, 0.2, -3}, {0, 1.2, 3}, 0.3);
  CHECK(shape_volume(round, mesh, 2) == Approx(1 - (4 - k_pi) * 0.09 / 2));
  CHECK(share(round, mesh_of({-1, 0, -1}, {2, 1.5, 1}, 0.01), 2) == Approx(1).epsilon(1e-3));
  CHECK(share(round, mesh_of({-1, 0, -1}, {2, 1.5, 1}, 0.05), 3) == Approx(1).epsilon(2e-3));
}

TEST_CASE("a half of a disc or ball has half its particles and half its volume", "[shapes]") {
  for (int dim : {2, 3}) {
    const auto whole = mesh_of({-1, -1, -1}, {1, 1, 1}, 0.1), half = mesh_of({0, -1, -1}, {1, 1, 1}, 0.1),
               corner = mesh_of({0, 0, 0}, {1, 1, 1}, 0.1);
    const Shape shape = round_shape(ShapeKind::disc, {0, 0, 0}, 0.83);
    const Lattice all = filled(shape, whole, dim);
    CHECK(2 * filled(shape, half, dim).position.size() == all.position.size());
    CHECK(filled(shape, corner, dim).position.size() << dim == all.position.size());
    CHECK(2 * shape_volume(shape, half, dim) == Approx(all.shape_volume).epsilon(1e-12));
    CHECK((1 << dim) * shape_volume(shape, corner, dim) == Approx(all.shape_volume).epsilon(1e-12));
  }
}

TEST_CASE("volumes of cylinders and cones are exact", "[shapes]") {
  const auto space = mesh_of({-9, -9, -9}, {9, 9, 9}, 1), quarter = mesh_of({0.5, 1, -9}, {9, 9, 9}, 1);
  for (const auto& [mesh, part] : {std::pair(space, 1.0), std::pair(quarter, 0.25)}) {
    const auto volume = [&](const Shape& shape) { return shape_volume(shape, mesh, 3); };
    CHECK(volume(cylinder({0.5, 1, 2}, 1.5, 4)) == Approx(part * k_pi * 2.25 * 4).epsilon(1e-12));
    CHECK(volume(cylinder({0.5, 1, 2}, 1.5, 4, 3)) == Approx(part * k_pi * 2.25 * 2).epsilon(1e-12));
    CHECK(volume(cone({0.5, 1, 2}, 1.5, 4, false)) == Approx(part * k_pi * 2.25 * 4 / 3).epsilon(1e-12));
    CHECK(volume(cone({0.5, 1, 2}, 1.5, 4, true)) == Approx(part * k_pi * 2.25 * 4 / 3).epsilon(1e-12));
  }
  // a cone cut across its axis at half its height
  const auto above = mesh_of({-9, -9, 4}, {9, 9, 9}, 1);
  CHECK(shape_volume(cone({0, 0, 2}, 1.5, 4, false), above, 3) ==
        Approx(k_pi * 2.25 * 4 / 3 * 7 / 8).epsilon(1e-12));
}

TEST_CASE("a part of what is round has the volume of its particles, wherever the mesh cuts it", "[shapes]") {
  Dice dice{std::mt19937_64(12)};
  for (int trial = 0; trial < 30; ++trial) {
    Shape shape = any_shape(dice, 3);
    if (shape.kind == ShapeKind::half_plane || shape.kind == ShapeKind::polygon) continue;
    shape.fill = Fill::centre, shape.radius = std::max(shape.radius, 0.3);
    shape.height = std::max(shape.height, 0.4), shape.tip_height = std::min(shape.tip_height, shape.height);
    const auto mesh = mesh_of({-1, 0, -1}, {2, 1.5, 1}, 0.05);
    const Lattice lattice = filled(shape, mesh, 3);
    // a flat end counts by half a layer of particles, the rest by less
    const double slack =
        k_pi / 2 * lattice.spacing * std::pow(shape.radius, 2) + 0.02 * std::pow(shape.radius, 3);
    INFO("trial " << trial << ", kind " << int(shape.kind));
    CHECK(std::abs(lattice.position.size() / 3 * lattice.particle_volume - lattice.shape_volume) < slack);
  }
}

TEST_CASE("a cylinder's lower end may be a cone, and its section is that of its inside", "[shapes]") {
  Dice dice{std::mt19937_64(13)};
  for (const Shape& shape : {cylinder({1, 2, 3}, 0.5, 2), cylinder({1, 2, 3}, 0.5, 2, 0.8),
                             cone({1, 2, 3}, 0.5, 2, false), cone({1, 2, 3}, 0.5, 2, true)}) {
    const Polygon section = section_of(shape, 0, 0);
    const auto [low, high] = ends_of(shape);
    CHECK(high - low == Approx(2));
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < section.size(); ++k) edges.push_back(edge_of(section, k));
    int inside = 0;
    for (int n = 0; n < 5000; ++n) {
      const double off = dice(0, 0.6), turn = dice(0, 7), z = dice(low - 0.2, high + 0.2);
      const Vec3 x{1 + off * std::cos(turn), 2 + off * std::sin(turn), z};
      const bool holds = revolved_holds(shape, x, 1e-12);
      inside += holds;
      if (holds != is_inside(edges, {off, z}, 1e-12)) FAIL_CHECK(off << ' ' << z);
    }
    CHECK(inside > 500);
  }
}

TEST_CASE("filling skips the sites of a row that cannot hold anything", "[shapes]") {
  // 5.8e10 sites; those of the rows in question are 1e5.
  const auto mesh = mesh_of({0, 0}, {120000, 120000}, 1);
  Shape corner;
  corner.kind = ShapeKind::half_plane, corner.point = {120000, 119900},
  corner.normal = {-k_pi / 4, -k_pi / 4};
  const double length = std::hypot(corner.normal[0], corner.normal[1]);
  for (double& n : corner.normal) n /= length;
  const auto start = std::chrono::steady_clock::now();
  CHECK(filled(corner, mesh, 2).position.size() == 2 * (200 * 201 / 2));
  Shape strip;
  strip.kind = ShapeKind::half_plane, strip.point = {0, 0}, strip.normal = {1, 0, 0};
  strip.point[0] = 119999.9;
  strip.normal[0] = -1;
  CHECK(filled(strip, mesh, 2).position.empty());
  // at 1e9 sites a second all of them would take a minute each
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < 20);
}
