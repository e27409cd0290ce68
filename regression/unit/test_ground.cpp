// Shapes of the ground: surfaces of triangles and layers, and the parts of cells that they cut.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "ground_shapes.hpp"
#include "input/geometry/cut_cells.hpp"
#include "input/geometry/region.hpp"
#include "input/geometry/shapes.hpp"

using namespace mpm;
using namespace mpm::test;
using Catch::Approx;

namespace {

Lattice filled(const Shape& shape, const MeshConfig& mesh, int dim) {
  Lattice lattice;
  REQUIRE(fill(shape, mesh, dim, lattice) == PETSC_SUCCESS);
  CHECK(holds_particle(shape, mesh, dim) == !lattice.position.empty());
  return lattice;
}

/// Volume and centre of mass of particles.
struct Moments {
  double volume = 0;
  Vec3 centre{};
  explicit Moments(const Lattice& lattice) {
    for (std::size_t p = 0; p < lattice.volume.size(); ++p) {
      volume += lattice.volume[p];
      for (int d = 0; d < lattice.dim; ++d)
        centre[d] += lattice.volume[p] * lattice.position[p * lattice.dim + d];
    }
    for (double& x : centre) x /= volume;
  }
};

}  // namespace

TEST_CASE("particles of a ball of triangles have its volume and centre", "[ground]") {
  const auto mesh = mesh_of({-2, -2, -2}, {2, 2, 2}, 0.2);
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Vec3 centre{0.013 * seed, -0.02 * seed, 0.031};
    const Shape shape = stl(turned_at_random(ball(centre, 1.3, 6), centre, seed));
    const Lattice lattice = filled(shape, mesh, 3);
    const Moments held(lattice);
    CHECK(lattice.shape_volume == Approx(k_ball * std::pow(1.3, 3)).epsilon(1e-3));
    CHECK(held.volume == Approx(lattice.shape_volume).epsilon(1e-9));
    for (int d = 0; d < 3; ++d) CHECK(std::abs(held.centre[d] - centre[d]) < 1e-9);
  }
}

TEST_CASE("particles of cut round shapes and polygons have their volume", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {4, 4, 4}, 0.25);
  Shape shape;
  shape.fill = Fill::cut, shape.centre = {2.03, 1.98, 2.01}, shape.radius = 1.2;
  for (const int per_cell : {1, 2, 3}) {
    shape.particles_per_cell = per_cell;
    for (const ShapeKind kind : {ShapeKind::disc, ShapeKind::cylinder, ShapeKind::cone}) {
      shape.kind = kind, shape.height = 1.7, shape.tip_height = kind == ShapeKind::cylinder ? 0.6 : 0;
      const Lattice lattice = filled(shape, mesh, 3);
      CHECK(Moments(lattice).volume == Approx(lattice.shape_volume).epsilon(1e-9));
    }
    shape.kind = ShapeKind::disc;
    CHECK(Moments(filled(shape, mesh, 2)).volume == Approx(std::numbers::pi * 1.44).epsilon(1e-9));
    Shape wedge;
    wedge.kind = ShapeKind::polygon, wedge.fill = Fill::cut, wedge.particles_per_cell = per_cell;
    wedge.polygon = {{0.3, 0.1}, {3.7, 0.1}, {3.7, 1.33}}, wedge.width = {0.11, 2.9};
    const double area = 3.4 * 1.23 / 2;
    CHECK(Moments(filled(wedge, mesh, 2)).volume == Approx(area).epsilon(1e-9));
    const Moments prism(filled(wedge, mesh, 3));
    CHECK(prism.volume ==
          Approx(2.79 * area).epsilon(1e-5));  // less what is thinner than a thousandth of a cell
    CHECK(prism.centre[0] == Approx(0.3 + 3.4 * 2 / 3));
    CHECK(prism.centre[2] == Approx(0.1 + 1.23 / 3));
  }
}

TEST_CASE("a half of a ball that a plane of symmetry cuts has half its volume", "[ground]") {
  Shape shape;
  shape.kind = ShapeKind::disc, shape.fill = Fill::cut, shape.centre = {0, 0, 0}, shape.radius = 1.13;
  const Lattice lattice = filled(shape, mesh_of({0, 0, 0}, {2, 2, 2}, 0.2), 3);
  CHECK(Moments(lattice).volume == Approx(k_ball * std::pow(1.13, 3) / 8).epsilon(1e-9));
  CHECK(lattice.shape_volume == Approx(k_ball * std::pow(1.13, 3) / 8).epsilon(1e-9));
}

TEST_CASE("particles of tilted layers have the volumes between planes, in 2D and 3D", "[ground]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> slope(-0.3, 0.3);
  for (int trial = 0; trial < 10; ++trial) {
    const double a = slope(random), b = slope(random), c = slope(random), d = slope(random);
    const auto mesh = mesh_of({0, 0, 0}, {5, 3, 6}, 0.5);
    const auto upper = [&](double x, double y) { return 4 + a * (x - 2.5) + b * (y - 1.5); };
    const auto lower = [&](double x, double y) { return 2 + c * (x - 2.5) + d * (y - 1.5); };
    const Shape slab = layer(raster(-1, -1, 0.37, 22, 16, upper), raster(-2, -2, 1.3, 9, 8, lower));
    const Lattice lattice = filled(slab, mesh, 3);
    const Moments held(lattice);
    CHECK(held.volume == Approx(30).epsilon(1e-9));
    CHECK(lattice.shape_volume == Approx(30).epsilon(1e-12));
    CHECK(held.centre[0] == Approx(2.5 + (a - c) * 25 / 12 / 2).epsilon(1e-9));
    const auto plane = mesh_of({0, 0}, {5, 6}, 0.5);
    const Shape strip = layer(polyline({0, 5}, {4 - 2.5 * a, 4 + 2.5 * a}),
                              polyline({-1, 2, 7}, {lower(-1, 1.5), lower(2, 1.5), lower(7, 1.5)}));
    CHECK(Moments(filled(strip, plane, 2)).volume == Approx(10).epsilon(1e-9));
    CHECK(Moments(filled(strip, mesh, 3)).volume == Approx(30).epsilon(1e-9));
  }
}

TEST_CASE("a raster's surface has the volume of the bilinear one", "[ground]") {
  const auto hills = [](double x, double y) { return 2 + std::sin(1.7 * x) * std::cos(2.3 * y); };
  const auto surface = raster(0, 0, 0.5, 8, 6, hills);
  double volume = 0;  // of the bilinear surface, by its quarters: cells and their halves at the rim
  const auto &x = surface->lines(0), &y = surface->lines(1);
  for (std::size_t j = 0; j + 1 < y.size(); ++j)
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
      volume += (x[i + 1] - x[i]) * (y[j + 1] - y[j]) / 4 *
                (surface->node(i, j) + surface->node(i + 1, j) + surface->node(i, j + 1) +
                 surface->node(i + 1, j + 1));
  const Lattice lattice = filled(layer(surface, level(0.13)), mesh_of({0, 0, 0}, {4, 3, 4}, 0.25), 3);
  CHECK(Moments(lattice).volume == Approx(volume - 12 * 0.13).epsilon(1e-9));
  CHECK(surface->at(0.1, 0.1) == surface->node(1, 1));  // level in the outer half of the rim
}

TEST_CASE("the bounds of a layer are those of the part where its surfaces are apart", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {20, 20, 20}, 0.5);
  const auto slope = [](double x, double y) { return 3 + 0.5 * x + 0.1 * y; };
  const auto hollow = [&](double x, double y) {
    return slope(x, y) - std::max(0.0, 2 * (1 - std::pow((x - 12.2) / 3, 2) - std::pow((y - 7.3) / 2, 2)));
  };
  const Shape scoop = layer(raster(-1, -1, 0.4, 56, 57, slope), raster(-1, -1, 0.4, 56, 57, hollow));
  const Bounds bounds = bounds_of(scoop, mesh, 3);
  CHECK((bounds.lower[0] > 8 && bounds.upper[0] < 16.1 && bounds.lower[1] > 4.4 && bounds.upper[1] < 10.2));
  CHECK((bounds.lower[2] > 6 && bounds.upper[2] < 12.2));
  const Lattice lattice = filled(scoop, mesh, 3);
  CHECK(Moments(lattice).volume == Approx(lattice.shape_volume).epsilon(1e-4));
  CHECK(lattice.shape_volume == Approx(std::numbers::pi * 6).epsilon(0.02));
}

TEST_CASE("a box of triangles has the particles of the box", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {4, 4, 4}, 0.5);
  Shape same;
  same.lower = {0.5, 1, 0.25}, same.upper = {3, 2.5, 3.5};
  const Lattice expected = filled(same, mesh, 3), got = filled(stl(box(same.lower, same.upper)), mesh, 3);
  REQUIRE(got.position.size() == expected.position.size());
  for (std::size_t k = 0; k < got.position.size(); ++k)
    CHECK(got.position[k] == Approx(expected.position[k]).epsilon(1e-14));
  for (const double volume : got.volume) CHECK(volume == got.particle_volume);
  Shape centres = stl(box(same.lower, same.upper));
  centres.fill = Fill::centre;
  CHECK(filled(centres, mesh, 3).position == got.position);
}

TEST_CASE("parts of a cut lattice are the whole to the bit, and none of its particles is small", "[ground]") {
  const auto mesh = mesh_of({-2, -2, -2}, {2, 2, 2}, 0.25);
  const Shape shape = stl(turned_at_random(ball({0.1, 0, 0}, 1.37, 4), {0.1, 0, 0}, 3));
  const Lattice whole = filled(shape, mesh, 3);
  for (const double volume : whole.volume) CHECK(volume >= k_least_part * whole.particle_volume);
  for (const int parts : {2, 3, 7, 40}) {
    std::vector<double> position, volume;
    for (int k = 0; k < parts; ++k) {
      Lattice part;
      REQUIRE(fill(shape, mesh, 3, part, {}, {k, parts}) == PETSC_SUCCESS);
      position.insert(position.end(), part.position.begin(), part.position.end());
      volume.insert(volume.end(), part.volume.begin(), part.volume.end());
    }
    CHECK(position == whole.position);
    CHECK(volume == whole.volume);
  }
}

TEST_CASE("a point is in a surface of triangles where it is in the solid", "[ground]") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> at(-1.5, 1.5);
  const Shape round = stl(ball({0, 0, 0}, 1, 6)), square = stl(box({-1, -1, -1}, {1, 1, 1}));
  Region in_round(round, 3, 0), in_square(square, 3, 0);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 x{at(random), at(random), at(random)};
    const double r = std::hypot(x[0], x[1], x[2]);
    if (std::abs(r - 1) > 1e-3) CHECK(in_round.holds(x) == (r < 1));
    CHECK(in_square.holds(x) == (std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) < 1));
  }
  // Below vertices and edges, where a line upwards meets several triangles.
  for (const double x : {-1.0, -0.5, 0.0, 0.5})
    for (const double y : {-1.0, -0.5, 0.0, 0.5}) CHECK(in_square.holds({x, y, 0}));
  CHECK(in_round.holds({0, 0, 0}));
  CHECK(in_round.holds({0, 0, -0.999}));
  CHECK_FALSE(in_round.holds({0, 0, -1.001}));
}

TEST_CASE("a point is in a prism of thin triangles across the axes where it is in the solid", "[ground]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(-1, 4), across(-1, 3), up(-0.5, 1.5);
  for (const int strips : {1, 7, 300}) {
    const double c = std::cos(0.7), s = std::sin(0.7);
    const auto place = [&](double u, double v, double z) { return Vec3{c * u - s * v, s * u + c * v, z}; };
    Corners corners;
    const auto quad = [&](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& t) {
      for (const Vec3& x : {p, q, r, p, r, t}) corners.push_back(x);
    };
    for (int k = 0; k < strips; ++k) {
      const double a = 2.0 * k / strips, b = 2.0 * (k + 1) / strips;
      quad(place(0, a, 1), place(3, a, 1), place(3, b, 1), place(0, b, 1));
      quad(place(0, a, 0), place(0, b, 0), place(3, b, 0), place(3, a, 0));
      quad(place(0, b, 0), place(0, a, 0), place(0, a, 1), place(0, b, 1));
      quad(place(3, a, 0), place(3, b, 0), place(3, b, 1), place(3, a, 1));
    }
    quad(place(0, 0, 0), place(3, 0, 0), place(3, 0, 1), place(0, 0, 1));
    quad(place(3, 2, 0), place(0, 2, 0), place(0, 2, 1), place(3, 2, 1));
    const TriangleSurface surface(corners);
    REQUIRE(fault_of(surface) == "");
    for (int n = 0; n < 20000; ++n) {
      const double u = along(random), v = across(random), z = up(random);
      const bool inside = u > 0 && u < 3 && v > 0 && v < 2 && z > 0 && z < 1;
      if (surface.holds(place(u, v, z), 0) != inside) FAIL("at " << u << ", " << v << ", " << z);
    }
  }
}

TEST_CASE("a raster far finer than the mesh counts by blocks of cells", "[ground]") {
  Raster raster{50, 30, -1, 2, 0.01, {}};
  for (long j = 0; j < 30; ++j)
    for (long i = 0; i < 50; ++i) raster.values.push_back(3 + 0.1 * (i + 0.5) - 0.2 * (j + 0.5));
  CHECK(block_under_mesh(raster, 0.16) == 1);
  CHECK(block_under_mesh(raster, 0.319) == 1);
  CHECK(block_under_mesh(raster, 0.33) == 2);
  CHECK(block_under_mesh(raster, 1e6) == 50);
  for (const long block : {1L, 3L, 7L, 50L}) {
    const auto surface = surface_of(raster, block);
    CHECK(surface->lines(0).front() == -1);
    CHECK(std::abs(surface->lines(0).back() + 0.5) < 1e-12);
    CHECK(surface->lines(0).size() == std::size_t(2 + (50 + block - 1) / block));
    CHECK(surface->lines(1).size() == std::size_t(2 + (30 + block - 1) / block));
    for (std::size_t k = 1; k + 1 < surface->lines(0).size() && k + 1 < surface->lines(1).size(); ++k) {
      const double x = surface->lines(0)[k], y = surface->lines(1)[k];  // a plane goes through all means
      CHECK(std::abs(surface->at(x, y) - (3 + 0.1 * (x + 1) / 0.01 - 0.2 * (y - 2) / 0.01)) < 1e-9);
    }
  }
  raster.values[40] = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(surface_of(raster, 7)->at(raster.x + 0.405, raster.y)));
}

TEST_CASE("two million triangles are checked and cut", "[ground][.long]") {
  const auto mesh = mesh_of({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 0.05);
  const Shape shape = stl(ball({0, 0, 0}, 1.3, 9));
  REQUIRE(shape.triangles->size() == 2097152);
  CHECK(fault_of(*shape.triangles).empty());
  CHECK(Moments(filled(shape, mesh, 3)).volume == Approx(k_ball * std::pow(1.3, 3)).epsilon(1e-5));
}
