// Volume, centre and inertia of shapes: closed forms of solids (Meriam & Kraige, Engineering Mechanics:
// Dynamics, tables D/3 and D/4), and sums over a grid of points that the program takes for the inside.

#include <algorithm>
#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "ground_shapes.hpp"
#include "input/geometry/mass_properties.hpp"
#include "input/geometry/region.hpp"
#include "input/geometry/shapes.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_round_off = 1e-13;

Shape brick(Vec3 lower, Vec3 upper, double fillet = 0, double angle = 0) {
  Shape shape;
  shape.lower = lower, shape.upper = upper, shape.fillet = fillet, shape.angle = angle;
  return shape;
}

Shape prism(Polygon polygon, std::array<double, 2> width = {}) {
  Shape shape;
  shape.kind = ShapeKind::polygon, shape.polygon = std::move(polygon), shape.width = width;
  return shape;
}

Shape disc(Vec3 centre, double radius) {
  Shape shape;
  shape.kind = ShapeKind::disc, shape.centre = centre, shape.radius = radius;
  return shape;
}

Shape cylinder(Vec3 centre, double radius, double height, double tip = 0) {
  Shape shape = disc(centre, radius);
  shape.kind = ShapeKind::cylinder, shape.height = height, shape.tip_height = tip;
  return shape;
}

Shape cone(Vec3 tip, double radius, double height, bool tip_up = false) {
  Shape shape = disc(tip, radius);
  shape.kind = ShapeKind::cone, shape.height = height, shape.tip_up = tip_up;
  return shape;
}

const Polygon k_angle{{0.2, 0.1}, {1.7, 0.1}, {1.7, 0.4}, {0.5, 0.4}, {0.5, 1.1}, {0.2, 1.1}};  // not convex

/// Tetrahedron of the legs a, b and c [m] along the axes.
Corners tetrahedron(const Vec3& at, double a, double b, double c) {
  const Vec3 o = at, x{at[0] + a, at[1], at[2]}, y{at[0], at[1] + b, at[2]}, z{at[0], at[1], at[2] + c};
  return {o, y, x, o, z, y, o, x, z, x, y, z};
}

std::vector<Shape> plane_shapes() {
  return {brick({0.2, 0.3}, {1.4, 0.9}),
          brick({0.2, 0.3}, {1.4, 0.9}, 0.25),
          brick({0.2, 0.3}, {1.4, 0.9}, 0.25, 0.7),
          disc({0.4, -0.3}, 0.8),
          prism(k_angle),
          prism({{0, 0}, {0.3, 1.1}, {2, 0.2}})};
}

std::vector<Shape> solid_shapes() {
  return {brick({0.2, 0.3, 0.1}, {1.4, 0.9, 2.1}),
          brick({0.2, 0.3, 0.1}, {1.4, 0.9, 1.1}, 0.2),
          brick({0.2, 0.3, 0.1}, {1.4, 0.9, 1.1}, 0.2, -2.3),
          disc({0.4, -0.3, 0.7}, 0.8),
          prism(k_angle, {-0.2, 0.9}),
          cylinder({0.1, 0.2, 0.3}, 0.4, 1.5),
          cylinder({0.1, 0.2, 0.3}, 0.4, 1.5, 0.6),
          cylinder({0.1, 0.2, 0.3}, 0.4, 0.6, 0.6),
          cone({0.1, 0.2, 0.3}, 0.7, 0.9),
          cone({0.1, 0.2, 0.3}, 0.7, 0.9, true),
          stl(turned_at_random(tetrahedron({0.5, 0.2, -0.3}, 1, 1.5, 0.8), {}, 3))};
}

/// Largest difference: of volumes and inertias as a share, of centres over the length of the inertia.
double difference(const MassProperties& a, const MassProperties& b) {
  double most = std::abs(a.volume / b.volume - 1), largest = 0, apart = 0;
  for (const double component : b.inertia) largest = std::max(largest, std::abs(component));
  for (int d = 0; d < 3; ++d) apart = std::max(apart, std::abs(a.centre[d] - b.centre[d]));
  for (int k = 0; k < 6; ++k) most = std::max(most, std::abs(a.inertia[k] - b.inertia[k]) / largest);
  return std::max(most, apart / std::sqrt(largest / b.volume));
}

MassProperties of(const Shape& shape, int dim) {
  const auto properties = mass_properties(shape, dim);
  REQUIRE(properties);
  return *properties;
}

MassProperties of_area(double area, Vec3 centre, double polar) {
  return {area, centre, {0, 0, polar, 0, 0, 0}};
}

using Matrix = std::array<Vec3, 3>;

/// R I R^T.
Sym6 turned_by(const Matrix& r, const Sym6& i) {
  const Matrix full{Vec3{i[0], i[3], i[5]}, {i[3], i[1], i[4]}, {i[5], i[4], i[2]}};
  const auto at = [&](int a, int b) {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
      for (int d = 0; d < 3; ++d) sum += r[a][c] * full[c][d] * r[b][d];
    return sum;
  };
  return {at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(2, 0)};
}

Vec3 turned_by(const Matrix& r, const Vec3& x) {
  Vec3 y{};
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 3; ++c) y[a] += r[a][c] * x[c];
  return y;
}

MassProperties turned_by(const Matrix& r, const MassProperties& body) {
  return {body.volume, turned_by(r, body.centre), turned_by(r, body.inertia)};
}

/// Turn about an axis of length 1 (Rodrigues).
Matrix rotation(const Vec3& n, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), u = 1 - c;
  return {Vec3{c + u * n[0] * n[0], u * n[0] * n[1] - s * n[2], u * n[0] * n[2] + s * n[1]},
          {u * n[1] * n[0] + s * n[2], c + u * n[1] * n[1], u * n[1] * n[2] - s * n[0]},
          {u * n[2] * n[0] - s * n[1], u * n[2] * n[1] + s * n[0], c + u * n[2] * n[2]}};
}

/// Both together (parallel axes), or one without the other where `sign` is -1.
MassProperties joined(const MassProperties& a, const MassProperties& b, double sign = 1) {
  MassProperties sum{a.volume + sign * b.volume, {}, {}};
  for (int d = 0; d < 3; ++d)
    sum.centre[d] = (a.volume * a.centre[d] + sign * b.volume * b.centre[d]) / sum.volume;
  for (const auto* part : {&a, &b}) {
    const double share = part == &a ? 1 : sign;
    Vec3 x;
    for (int d = 0; d < 3; ++d) x[d] = part->centre[d] - sum.centre[d];
    const double mass = share * part->volume, square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    for (int d = 0; d < 3; ++d) sum.inertia[d] += share * part->inertia[d] + mass * (square - x[d] * x[d]);
    for (int d = 0; d < 3; ++d)
      sum.inertia[3 + d] += share * part->inertia[3 + d] - mass * x[d] * x[(d + 1) % 3];
  }
  if (a.inertia[0] == 0) sum.inertia = {0, 0, sum.inertia[2], 0, 0, 0};  // in a plane
  return sum;
}

Shape moved(Shape shape, const Vec3& by, int dim) {
  for (int d = 0; d < dim; ++d) shape.lower[d] += by[d], shape.upper[d] += by[d], shape.centre[d] += by[d];
  for (Point2& point : shape.polygon) point[0] += by[0], point[1] += by[dim - 1];
  for (double& y : shape.width) y += by[1];
  if (!shape.triangles) return shape;
  Corners corners;
  for (int k = 0; k < shape.triangles->size(); ++k)
    for (int c = 0; c < 3; ++c) {
      Vec3 x = shape.triangles->corner(k, c);
      for (int d = 0; d < 3; ++d) x[d] += by[d];
      corners.push_back(x);
    }
  return stl(corners);
}

Sym6 inertia_of(const Sym6& second, int dim) {
  const double xx = second[0], yy = second[1], zz = second[2];
  if (dim == 2) return {0, 0, xx + yy, 0, 0, 0};
  return {yy + zz, zz + xx, xx + yy, -second[3], -second[4], -second[5]};
}

/// Sums over the cells of a grid, of which `cells` are along the bounds, whose centres are inside.
MassProperties counted(const Shape& shape, int dim, int cells) {
  const Bounds bounds = bounds_of(shape, {}, dim);
  Region region(shape, dim, 0);
  std::array<int, 3> count{cells, cells, dim == 3 ? cells : 1};
  Vec3 edge{};
  double cell = 1;
  for (int d = 0; d < dim; ++d) edge[d] = (bounds.upper[d] - bounds.lower[d]) / cells, cell *= edge[d];
  const int up = dim - 1;
  MassProperties sum;
  Sym6 second{};
  for (int n = 0; n < count[0] * count[1] * count[2]; ++n) {  // the vertical coordinate varies slowest
    const std::array<int, 3> at{n % count[0], n / count[0] % count[1], n / count[0] / count[1]};
    Vec3 x{}, middle{};
    for (int d = 0; d < dim; ++d)
      middle[d] = (bounds.lower[d] + bounds.upper[d]) / 2, x[d] = bounds.lower[d] + (at[d] + 0.5) * edge[d];
    region.enter_row(x[up], x[up]);
    if (!region.holds(x)) continue;
    sum.volume += cell;
    for (int d = 0; d < 3; ++d) x[d] -= middle[d], sum.centre[d] += cell * x[d];
    for (int d = 0; d < 3; ++d) {
      second[d] += cell * (x[d] * x[d] + edge[d] * edge[d] / 12);
      second[3 + d] += cell * x[d] * x[(d + 1) % 3];
    }
  }
  for (int d = 0; d < 3; ++d) sum.centre[d] /= sum.volume;
  const Vec3 c = sum.centre;
  for (int d = 0; d < 3; ++d)
    second[d] -= sum.volume * c[d] * c[d], second[3 + d] -= sum.volume * c[d] * c[(d + 1) % 3];
  sum.inertia = inertia_of(second, dim);
  for (int d = 0; d < dim; ++d) sum.centre[d] += (bounds.lower[d] + bounds.upper[d]) / 2;
  return sum;
}

}  // namespace

TEST_CASE("plane shapes have the areas and polar moments of the tables", "[mass_properties]") {
  const double a = 1.2, b = 0.5, r = 0.3;
  CHECK(difference(of(brick({1, 2}, {1 + a, 2 + b}), 2),
                   of_area(a * b, {1 + a / 2, 2 + b / 2}, a * b * (a * a + b * b) / 12)) < k_round_off);
  CHECK(difference(of(disc({1, 2}, r), 2), of_area(k_pi * r * r, {1, 2}, k_pi * std::pow(r, 4) / 2)) <
        k_round_off);
  const Polygon triangle{{0.1, 0.2}, {1.3, -0.4}, {0.7, 1.9}};
  double squares = 0;
  for (int k = 0; k < 3; ++k)
    for (int d = 0; d < 2; ++d) squares += std::pow(triangle[k][d] - triangle[(k + 1) % 3][d], 2);
  const double area = (1.2 * 1.7 + 0.6 * 0.6) / 2;
  CHECK(difference(of(prism(triangle), 2), of_area(area, {2.1 / 3, 1.7 / 3}, area * squares / 36)) <
        k_round_off);
}

TEST_CASE("a rounded rectangle is a cross of rectangles and quarters of a disc", "[mass_properties]") {
  const double a = 1.6, b = 0.9, r = 0.2, e = a / 2 - r, f = b / 2 - r;
  const auto rectangle = [](double x, double y) { return of(brick({-x, -y}, {x, y}), 2); };
  MassProperties sum = joined(joined(rectangle(a / 2, f), rectangle(e, b / 2)), rectangle(e, f), -1);
  const double quarter = k_pi * r * r / 4, off = 4 * r / (3 * k_pi);
  const double own = k_pi * std::pow(r, 4) / 8 - quarter * 2 * off * off;  // about its centre of mass
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      sum = joined(sum, of_area(quarter, {x * (e + off), y * (f + off)}, own));
  CHECK(difference(of(brick({-a / 2, -b / 2}, {a / 2, b / 2}, r), 2), sum) < k_round_off);
  CHECK(difference(of(brick({0, 0}, {1, 1}, 0.5), 2), of(disc({0.5, 0.5}, 0.5), 2)) < k_round_off);
}

TEST_CASE("solids have the volumes, centres and inertias of the tables", "[mass_properties]") {
  const double r = 0.7, h = 1.9, a = 1.2, b = 0.5;
  const double box = a * b * h, pile = k_pi * r * r * h, tip = pile / 3, round = 4 * k_pi / 3 * r * r * r;
  const auto same = [](const Shape& shape, const MassProperties& expected) {
    return difference(of(shape, 3), expected) < k_round_off;
  };
  CHECK(
      same(brick({1, 2, 3}, {1 + a, 2 + b, 3 + h}),
           {box,
            {1 + a / 2, 2 + b / 2, 3 + h / 2},
            {box * (b * b + h * h) / 12, box * (h * h + a * a) / 12, box * (a * a + b * b) / 12, 0, 0, 0}}));
  const double of_ball = 0.4 * round * r * r;
  CHECK(same(disc({1, 2, 3}, r), {round, {1, 2, 3}, {of_ball, of_ball, of_ball, 0, 0, 0}}));
  const double pile_across = pile * (3 * r * r + h * h) / 12;
  CHECK(same(cylinder({1, 2, 3}, r, h),
             {pile, {1, 2, 3 + h / 2}, {pile_across, pile_across, pile * r * r / 2, 0, 0, 0}}));
  const double tip_across = 3 * tip * (4 * r * r + h * h) / 80;
  const Sym6 of_tip{tip_across, tip_across, 0.3 * tip * r * r, 0, 0, 0};
  CHECK(same(cone({1, 2, 3}, r, h), {tip, {1, 2, 3 + 0.75 * h}, of_tip}));
  CHECK(same(cone({1, 2, 3}, r, h, true), {tip, {1, 2, 3 - 0.75 * h}, of_tip}));
}

TEST_CASE("a penetrometer is a cylinder on a cone", "[mass_properties]") {
  const auto parts = joined(of(cone({1, 2, 3}, 0.4, 0.6), 3), of(cylinder({1, 2, 3.6}, 0.4, 0.9), 3));
  CHECK(difference(of(cylinder({1, 2, 3}, 0.4, 1.5, 0.6), 3), parts) < k_round_off);
  CHECK(difference(of(cylinder({1, 2, 3}, 0.4, 0.6, 0.6), 3), of(cone({1, 2, 3}, 0.4, 0.6), 3)) <
        k_round_off);
}

TEST_CASE("a box with fillets of half its width is a cylinder with two halves of a ball, or a ball",
          "[mass_properties]") {
  const double r = 0.4, l = 1.3, rod = k_pi * r * r * l, balls = 4 * k_pi / 3 * r * r * r;
  const double across = rod * (r * r / 4 + l * l / 12) + balls * (0.4 * r * r + l * l / 4 + 3 * l * r / 8);
  const MassProperties expected{rod + balls,
                                {1 + r, 2 + r, 3 + l / 2 + r},
                                {across, across, rod * r * r / 2 + balls * 0.4 * r * r, 0, 0, 0}};
  CHECK(difference(of(brick({1, 2, 3}, {1 + 2 * r, 2 + 2 * r, 3 + 2 * r + l}, r), 3), expected) <
        k_round_off);
  CHECK(difference(of(brick({1, 2, 3}, {2, 3, 4}, 0.5), 3), of(disc({1.5, 2.5, 3.5}, 0.5), 3)) < k_round_off);
}

TEST_CASE("a turned box has the turned inertia", "[mass_properties]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int n = 0; n < 50; ++n) {
    Vec3 lower, upper;
    for (int d = 0; d < 3; ++d)
      lower[d] = 2 * uniform(random) - 1, upper[d] = lower[d] + 0.5 + uniform(random);
    const double fillet = n % 2 ? 0.25 * uniform(random) : 0, angle = 2 * k_pi * (2 * uniform(random) - 1);
    MassProperties expected = of(brick(lower, upper, fillet), 3);
    for (int d = 0; d < 3; ++d) expected.centre[d] -= lower[d];
    expected = turned_by(rotation({0, -1, 0}, angle), expected);  // from x to z
    for (int d = 0; d < 3; ++d) expected.centre[d] += lower[d];
    CHECK(difference(of(brick(lower, upper, fillet, angle), 3), expected) < k_round_off);

    MassProperties plane = of(brick(lower, upper, fillet), 2);
    const double x = plane.centre[0] - lower[0], y = plane.centre[1] - lower[1];
    plane.centre[0] = lower[0] + std::cos(angle) * x - std::sin(angle) * y;
    plane.centre[1] = lower[1] + std::sin(angle) * x + std::cos(angle) * y;
    CHECK(difference(of(brick(lower, upper, fillet, angle), 2), plane) < k_round_off);
  }
}

TEST_CASE("a polygon that is an angle is two rectangles, and its prism two boxes", "[mass_properties]") {
  const auto plane = joined(of(brick({0.2, 0.1}, {1.7, 0.4}), 2), of(brick({0.2, 0.4}, {0.5, 1.1}), 2));
  const auto solid =
      joined(of(brick({0.2, -2, 0.1}, {1.7, 5, 0.4}), 3), of(brick({0.2, -2, 0.4}, {0.5, 5, 1.1}), 3));
  const Polygon reversed(k_angle.rbegin(), k_angle.rend());
  for (const Polygon& polygon : {k_angle, reversed}) {
    CHECK(difference(of(prism(polygon), 2), plane) < k_round_off);
    CHECK(difference(of(prism(polygon, {-2, 5}), 3), solid) < k_round_off);
  }
  CHECK(std::abs(solid.inertia[5]) > 0.01 * solid.inertia[2]);
}

TEST_CASE("a mirrored prism has the mirrored inertia", "[mass_properties]") {
  Polygon mirrored = k_angle;
  for (Point2& point : mirrored) point[0] = -point[0];
  MassProperties expected = of(prism(k_angle, {-2, 5}), 3);
  expected.centre[0] *= -1, expected.inertia[3] *= -1, expected.inertia[5] *= -1;
  CHECK(difference(of(prism(mirrored, {-2, 5}), 3), expected) < k_round_off);
}

TEST_CASE("a surface of triangles has the properties of its polyhedron", "[mass_properties]") {
  const double a = 1.1, b = 0.6, c = 1.7, volume = a * b * c / 6;
  const MassProperties expected{
      volume,
      {1 + a / 4, 2 + b / 4, 3 + c / 4},
      {3 * volume * (b * b + c * c) / 80, 3 * volume * (c * c + a * a) / 80,
       3 * volume * (a * a + b * b) / 80, volume * a * b / 80, volume * b * c / 80, volume * c * a / 80}};
  CHECK(difference(of(stl(tetrahedron({1, 2, 3}, a, b, c)), 3), expected) < k_round_off);

  const Vec3 low{1, 2, 3}, high{2.5, 2.4, 4.2}, inner_low{1.2, 2.1, 3.1}, inner_high{1.9, 2.2, 3.8};
  CHECK(difference(of(stl(box(low, high)), 3), of(brick(low, high), 3)) < k_round_off);
  Corners hollow = box(low, high), inner = box(inner_low, inner_high);
  for (std::size_t k = 0; k < inner.size(); k += 3) std::swap(inner[k], inner[k + 1]);
  hollow.insert(hollow.end(), inner.begin(), inner.end());
  CHECK(difference(of(stl(hollow), 3),
                   joined(of(brick(low, high), 3), of(brick(inner_low, inner_high), 3), -1)) < k_round_off);
}

TEST_CASE("a surface of triangles turns with its inertia", "[mass_properties]") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 20; ++n) {
    Vec3 axis{normal(random), normal(random), normal(random)};
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    for (double& component : axis) component /= length;
    const Matrix turn = rotation(axis, 3 * normal(random));
    for (Corners corners :
         {tetrahedron({0.2, -0.4, 0.1}, 1, 1.5, 0.8), box({0.1, 0.2, 0.3}, {1.1, 0.7, 2})}) {
      const MassProperties expected = turned_by(turn, of(stl(corners), 3));
      for (Vec3& x : corners) x = turned_by(turn, x);
      CHECK(difference(of(stl(corners), 3), expected) < k_round_off);
    }
  }
}

TEST_CASE("triangles on a ball have the properties of the ball to second order", "[mass_properties]") {
  const MassProperties expected = of(disc({1, 2, 3}, 0.8), 3);
  double before = 0;
  for (int halvings = 3; halvings < 6; ++halvings) {
    const double error = difference(of(stl(ball({1, 2, 3}, 0.8, halvings)), 3), expected);
    if (before > 0) CHECK(before / error == Catch::Approx(4).epsilon(0.05));
    before = error;
  }
  CHECK(before < 0.005);
}

TEST_CASE("mass properties agree with a grid of points inside the shape", "[mass_properties]") {
  for (const Shape& shape : plane_shapes()) {
    INFO("2D, kind " << int(shape.kind) << ", fillet " << shape.fillet);
    CHECK(difference(counted(shape, 2, 1000), of(shape, 2)) < 2e-4);
  }
  for (const Shape& shape : solid_shapes()) {
    INFO("3D, kind " << int(shape.kind) << ", fillet " << shape.fillet << ", tip " << shape.tip_height);
    CHECK(difference(counted(shape, 3, 120), of(shape, 3)) < 2e-3);
  }
}

TEST_CASE("the volume is that of the filled shape", "[mass_properties]") {
  for (const Shape& shape : plane_shapes())
    CHECK(of(shape, 2).volume ==
          Catch::Approx(shape_volume(shape, mesh_of({-9, -9}, {9, 9}, 0.1), 2)).epsilon(1e-12));
  for (const Shape& shape : solid_shapes())
    CHECK(of(shape, 3).volume ==
          Catch::Approx(shape_volume(shape, mesh_of({-9, -9, -9}, {9, 9, 9}, 0.1), 3)).epsilon(1e-12));
}

TEST_CASE("a shape far from the origin has the same inertia", "[mass_properties]") {
  const Vec3 far{1 << 20, -(1 << 21), 1 << 19};  // m, to which all coordinates here add without round-off
  std::vector<Shape> shapes{brick({0.25, 0.5, 0.125}, {1.5, 1, 2}, 0.125, 0.7),
                            disc({0.5, -0.25, 0.75}, 0.8),
                            prism({{0, 0}, {1.5, 0.25}, {0.5, 1.75}}, {0.25, 1}),
                            cylinder({0.5, 0.25, 0.125}, 0.4, 1.5, 0.5),
                            cone({0.5, 0.25, 0.125}, 0.7, 0.75, true),
                            stl(tetrahedron({0.25, 0.5, 0.125}, 1.25, 0.75, 1.5))};
  for (const Shape& shape : shapes) {
    const MassProperties near = of(shape, 3);
    MassProperties back = of(moved(shape, far, 3), 3);
    for (int d = 0; d < 3; ++d) back.centre[d] -= far[d];
    INFO("kind " << int(shape.kind));
    CHECK(std::abs(back.volume / near.volume - 1) < k_round_off);
    for (int k = 0; k < 6; ++k)
      CHECK(std::abs(back.inertia[k] - near.inertia[k]) < k_round_off * near.inertia[2]);
    for (int d = 0; d < 3; ++d) CHECK(std::abs(back.centre[d] - near.centre[d]) < 1e-9);
  }
}

TEST_CASE("what ends with the mesh, or is a list, has no mass properties", "[mass_properties]") {
  Shape plane, list;
  plane.kind = ShapeKind::half_plane, plane.normal = {0, 1, 0};
  list.kind = ShapeKind::particles;
  for (int dim = 2; dim <= 3; ++dim) {
    CHECK(!mass_properties(plane, dim));
    CHECK(!mass_properties(list, dim));
    CHECK(!mass_properties(layer(level(1), level(0)), dim));
    CHECK(mass_properties(brick({0, 0, 0}, {1, 1, 1}), dim));
  }
}
