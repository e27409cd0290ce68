// Unions of shapes: distance, mass properties, and the points where other bodies touch.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include <cmath>

#include "clouds.hpp"
#include "ground_shapes.hpp"
#include "input/geometry/triangle_points.hpp"
#include "input/geometry/united.hpp"
#include "input/geometry/vectors.hpp"
#include "physics/surface.hpp"
#include "step/surface_input.hpp"
#include "step/surface_points.hpp"
#include "transfer/host_tables.hpp"

using namespace mpm;
using Catch::Approx;

namespace {

constexpr double k_spacing = 0.1;

MeshConfig mesh() { return test::mesh_of({-5, -5, -5}, {5, 5, 5}, k_spacing); }

Shape box_of(Vec3 lower, Vec3 upper, double angle = 0) {
  Shape shape;
  shape.lower = lower, shape.upper = upper, shape.angle = angle;
  return shape;
}

Shape polygon_of(std::vector<std::array<double, 2>> vertices, std::array<double, 2> width = {}) {
  Shape shape;
  shape.kind = ShapeKind::polygon, shape.polygon = std::move(vertices), shape.width = width;
  return shape;
}

Shape united(std::vector<Shape> parts) {
  Shape shape;
  shape.kind = ShapeKind::parts, shape.parts = std::move(parts);
  for (std::size_t n = 0; n < shape.parts.size(); ++n) shape.part_names.push_back("p" + std::to_string(n));
  return shape;
}

/// Distance to a shape by way of the tables that a run uploads.
template <int Dim>
class Measure {
 public:
  Measure(const Shape& shape, Corners corners) {
    HostTables<Dim> host;
    surface_ = host.add(surface_input(shape, mesh(), Dim, corners), k_spacing);
    host.upload(tables_);
  }
  Distance<Dim> operator()(const Vec3& x) const {
    Vector<double, Dim> at;
    for (int d = 0; d < Dim; ++d) at[d] = x[d] + 5;
    return distance_to(surface_, tables_, at);
  }

 private:
  SurfaceTables<Kokkos::HostSpace, Dim> tables_;
  Surface<Dim> surface_;
};

template <int Dim>
double off(const Distance<Dim>& a, const Distance<Dim>& b) {
  double sum = std::fabs(a.value - b.value);
  for (int d = 0; d < Dim; ++d) sum += std::fabs(a.normal[d] - b.normal[d]);
  return sum;
}

/// Largest difference of the properties of two solids, over their sizes.
double off(const MassProperties& a, const MassProperties& b) {
  double most = std::fabs(a.volume / b.volume - 1), size = 0;
  for (const double i : b.inertia) size = std::max(size, std::fabs(i));
  for (int d = 0; d < 3; ++d) most = std::max(most, std::fabs(a.centre[d] - b.centre[d]));
  for (int k = 0; k < 6; ++k) most = std::max(most, std::fabs(a.inertia[k] - b.inertia[k]) / size);
  return most;
}

// An L of a foot of 2 by 0.5 and a leg of 0.5 by 1.5: the leg on the foot, and down into it.
const std::vector<std::array<double, 2>> k_ell = {{0, 0}, {2, 0}, {2, 0.5}, {0.5, 0.5}, {0.5, 2}, {0, 2}};
Shape ell(int dim, double overlap) {
  const Vec3 low{0, 0, 0}, high = dim == 2 ? Vec3{2, 0.5, 0} : Vec3{2, 1, 0.5};
  const Vec3 leg_low = dim == 2 ? Vec3{0, 0.5 - overlap, 0} : Vec3{0, 0, 0.5 - overlap},
             leg_high = dim == 2 ? Vec3{0.5, 2, 0} : Vec3{0.5, 1, 2};
  return united({box_of(low, high), box_of(leg_low, leg_high)});
}

}  // namespace

TEST_CASE("two boxes on each other have the distance of an L", "[united]") {
  const Measure<2> whole(polygon_of(k_ell), Corners::sharp);
  const Measure<3> prism(polygon_of(k_ell, {0, 1}), Corners::sharp);
  test::Dice dice{std::mt19937_64(3)};
  std::uniform_real_distribution<double> draw(-0.5, 2.5);
  for (const double overlap : {0.0, 0.2, 0.5}) {
    const Measure<2> parts(ell(2, overlap), Corners::sharp);
    const Measure<3> solid(ell(3, overlap), Corners::sharp);
    int compared = 0;
    for (int n = 0; n < 4000; ++n) {
      const Vec3 x{draw(dice.engine), draw(dice.engine), 0}, y{x[0], draw(dice.engine) / 2, x[1]};
      const Distance<2> exact = whole(x);
      // Inside, round the corner that points inwards, the faces are those of one of the boxes alone.
      const bool at_corner = exact.value < 0 && x[0] < 0.5 && x[1] < 0.5;
      if (exact.value < -1.25 * k_spacing || at_corner) continue;
      ++compared;
      INFO("at " << x[0] << " " << x[1] << " of an overlap of " << overlap);
      REQUIRE(off(parts(x), exact) < 1e-12);
      if (prism(y).value > -1.25 * k_spacing) REQUIRE(off(solid(y), prism(y)) < 1e-12);
    }
    CHECK(compared > 2000);
  }
}

TEST_CASE("a box in two is the box, with rounded corners, turned, in 2D and 3D", "[united]") {
  test::Dice dice{std::mt19937_64(4)};
  std::uniform_real_distribution<double> draw(-2, 3);
  for (const double angle : {0.0, 0.5}) {
    const auto at = [&](double x) { return Vec3{x * std::cos(angle), x * std::sin(angle), 0}; };
    const Vec3 a = at(0.8);
    const Measure<2> whole(box_of({0, 0}, {2, 0.6}, angle), Corners::rounded),
        halves(united({box_of({0, 0}, {0.8, 0.6}, angle), box_of(a, {a[0] + 1.2, a[1] + 0.6}, angle)}),
               Corners::rounded);
    const Measure<3> solid(box_of({0, 0, 0}, {2, 1, 0.6}), Corners::rounded),
        two(united({box_of({0, 0, 0}, {0.8, 1, 0.6}), box_of({0.8, 0, 0}, {2, 1, 0.6})}), Corners::rounded);
    for (int n = 0; n < 2000; ++n) {
      const Vec3 x{draw(dice.engine), draw(dice.engine), draw(dice.engine)};
      if (whole(x).value > -1.25 * k_spacing) REQUIRE(off(halves(x), whole(x)) < 1e-12);
      if (solid(x).value > -1.25 * k_spacing) REQUIRE(off(two(x), solid(x)) < 1e-12);
    }
  }
}

TEST_CASE("mass properties of an L of boxes are those of the polygon", "[united]") {
  for (const int dim : {2, 3}) {
    const MassProperties exact = mass_properties(polygon_of(k_ell, {0, 1}), dim).value();
    for (const double overlap : {0.0, 0.2, 0.5}) {
      const Shape parts = ell(dim, overlap);
      CHECK(off(mass_properties(parts, dim).value(), exact) < 1e-12);
      CHECK(united_volume(parts, mesh(), dim) == Approx(exact.volume).epsilon(1e-12));
    }
  }
  // Three boxes round one corner: what all share counts once.
  const Shape three =
      united({box_of({0, 0}, {2, 1}), box_of({0, 0}, {1, 2}), box_of({0.5, 0.5}, {1.5, 1.5})});
  CHECK(united_volume(three, mesh(), 2) == Approx(3.25).epsilon(1e-12));
  // A ball and a cylinder up from its centre.
  Shape ball, shaft;
  ball.kind = ShapeKind::disc, ball.radius = 1;
  shaft.kind = ShapeKind::cylinder, shaft.radius = 0.5, shaft.height = 2;
  const double cap = std::sqrt(0.75);  // height of the ball over the rim of the shaft
  const double shared = M_PI * (0.25 * cap + 2. / 3 - cap + cap * cap * cap / 3);
  const MassProperties both = mass_properties(united({ball, shaft}), 3).value();
  CHECK(both.volume == Approx(4 * M_PI / 3 + M_PI / 2 - shared).epsilon(1e-3));
}

TEST_CASE("points of a union are on its surface", "[united]") {
  Config config;
  config.mesh = mesh();
  for (const int dim : {2, 3}) {
    config.dim = dim;
    const Shape parts = ell(dim, 0);
    const SurfacePoints points = surface_points(config, parts, /*faces*/ true);
    REQUIRE(points.points.size() > 10);
    for (const Vec3& from_corner : points.points) {
      Vec3 x;
      for (int d = 0; d < 3; ++d) x[d] = from_corner[d] - (d < dim ? 5 : 0);
      const double value = dim == 2 ? Measure<2>(polygon_of(k_ell), Corners::sharp)(x).value
                                    : Measure<3>(polygon_of(k_ell, {0, 1}), Corners::sharp)(x).value;
      CHECK(std::fabs(value) < 1e-12);
    }
  }
}

TEST_CASE("points of triangles: corners first, and near every place of the surface", "[united]") {
  const double apart = 0.5 * k_spacing;
  const Vec3 high{0.4, 0.3, 0.23};
  const auto cube = test::stl(test::box({0, 0, 0}, high)).triangles;
  for (const bool faces : {false, true}) {
    const auto points = triangle_points(cube, apart, faces);
    for (const TrianglePoint& point : points) {  // its ball is in the box, or comes out by little
      const Vec3 centre = along(point.x, -point.radius, point.normal);
      int ends = 0;
      for (int d = 0; d < 3; ++d) {
        REQUIRE(std::min(centre[d], high[d] - centre[d]) > point.radius - apart / 50 - 1e-6);
        ends += std::min(point.x[d], high[d] - point.x[d]) < 1e-9;
      }
      if (ends > 1) CHECK(point.radius == 0);
    }
    for (int n = 0; n < 8; ++n)
      for (int d = 0; d < 3; ++d) CHECK(std::fabs(points[n].normal[d]) == Approx(1 / std::sqrt(3.0)));
    for (std::size_t n = 0; n < points.size(); ++n)
      for (std::size_t m = 0; m < n; ++m)
        REQUIRE(length_of(difference(points[n].x, points[m].x)) > apart / 2 * (1 - 1e-6));
    test::Dice dice{std::mt19937_64(6)};
    std::uniform_real_distribution<double> draw(0, 1);
    for (int n = 0; n < 500; ++n) {
      Vec3 x{high[0] * draw(dice.engine), high[1] * draw(dice.engine), high[2] * draw(dice.engine)};
      x[n % 3] = n % 2 == 0 ? 0 : high[n % 3];
      if (!faces) x[(n + 1) % 3] = 0;  // on an edge
      double least = 1;
      for (const TrianglePoint& point : points) least = std::min(least, length_of(difference(point.x, x)));
      REQUIRE(least < apart);
    }
  }
  // Many small triangles are thinned.
  const auto ball = test::stl(test::ball({0, 0, 0}, 0.2, 6)).triangles;
  const auto few = triangle_points(ball, apart, true);
  CHECK(few.size() < 12 * 4 * M_PI * 0.04 / (apart * apart));
  for (const TrianglePoint& point : few) {
    REQUIRE(inner_product(point.normal, unit_of(point.x)) > 0.999);
    REQUIRE(point.radius == Approx(0.2).epsilon(0.05));
  }
}
