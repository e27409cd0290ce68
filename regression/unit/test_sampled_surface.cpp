// Distance to surfaces of triangles: exact, with rounded edges, and by samples.

#include <catch2/catch_test_macros.hpp>

#include "ground_shapes.hpp"
#include "input/geometry/rounded_surface.hpp"
#include "input/geometry/thickness.hpp"
#include "input/geometry/vectors.hpp"
#include "physics/surface.hpp"
#include "step/surface_input.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A prism along y over a polygon of x and z, anticlockwise and star-shaped about its first vertex.
std::vector<Vec3> prism(const std::vector<std::array<double, 2>>& outline, double low, double high) {
  std::vector<Vec3> corners;
  const auto at = [&](std::size_t k, double y) {
    const auto& p = outline[k % outline.size()];
    return Vec3{p[0], y, p[1]};
  };
  for (std::size_t k = 0; k < outline.size(); ++k) {
    for (const Vec3& x : {at(k, low), at(k + 1, low), at(k + 1, high)}) corners.push_back(x);
    for (const Vec3& x : {at(k, low), at(k + 1, high), at(k, high)}) corners.push_back(x);
  }
  for (std::size_t k = 1; k + 1 < outline.size(); ++k) {
    for (const Vec3& x : {at(0, low), at(k + 1, low), at(k, low)}) corners.push_back(x);
    for (const Vec3& x : {at(0, high), at(k, high), at(k + 1, high)}) corners.push_back(x);
  }
  for (std::size_t k = 0; k < corners.size(); k += 3) std::swap(corners[k + 1], corners[k + 2]);
  return corners;
}

/// A ring about the z axis, which has vertices of saddles.
std::vector<Vec3> ring(double radius, double thick, int around, int across) {
  const auto at = [&](int i, int j) {
    const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
    const double r = radius + thick * std::cos(b);
    return Vec3{r * std::cos(a), r * std::sin(a), thick * std::sin(b)};
  };
  std::vector<Vec3> corners;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const int n = (i + 1) % around, m = (j + 1) % across;
      for (const Vec3& x : {at(i, j), at(n, j), at(n, m), at(i, j), at(n, m), at(i, m)}) corners.push_back(x);
    }
  return corners;
}

/// Distance to a segment.
double to_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 edge = difference(b, a);
  const double t = inner_product(difference(x, a), edge) / inner_product(edge, edge);
  return length_of(difference(x, along(a, std::clamp(t, 0.0, 1.0), edge)));
}

/// Distance to a triangle: that to its plane over it, to an edge elsewhere.
double to_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 n = unit_of(outer_product(difference(b, a), difference(c, a)));
  bool over = true;
  for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}})
    over = over && inner_product(outer_product(difference(q, p), difference(x, p)), n) >= 0;
  if (over) return std::abs(inner_product(difference(x, a), n));
  return std::min({to_segment(a, b, x), to_segment(b, c, x), to_segment(c, a, x)});
}

/// Shapes that are hard on signs: a thin wedge, a notch, saddles, a needle, and a mixture turned at random.
std::vector<std::pair<std::string, std::vector<Vec3>>> hard_surfaces() {
  const std::vector<Vec3> wedge = prism({{-1, 0}, {1, -0.02}, {1, 0.02}}, -0.7, 0.8);
  const std::vector<Vec3> notch = prism({{-0.2, -0.4}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}, -1, 1);
  const std::vector<Vec3> needle = prism({{-0.01, 0}, {0, -0.01}, {0.01, 0}, {0, 0.01}}, -1, 1);
  return {{"wedge", wedge},
          {"notch", notch},
          {"ring", ring(1, 0.3, 13, 7)},
          {"needle", needle},
          {"turned notch", turned_at_random(notch, {}, 3)},
          {"turned wedge", turned_at_random(wedge, {}, 5)}};
}

/// Tables on the host, as kernels have them.
struct Tables {
  struct Grid {
    const SurfaceInput* in;
    const SampleGrid& operator()(int) const { return in->grid; }
  };
  template <class V>
  struct List {
    const V* values;
    const auto& operator()(int n) const { return (*values)[n]; }
  };
  Grid grids;
  List<std::vector<int>> blocks;
  List<std::vector<SurfaceSample>> samples;
  List<std::vector<unsigned char>> edges;

  explicit Tables(const SurfaceInput& in)
      : grids{&in}, blocks{&in.blocks}, samples{&in.samples}, edges{&in.edges} {}
  Vertex operator()(int) const { return {}; }
};

}  // namespace

TEST_CASE("the exact distance is that of all triangles, and its sign that of a ray", "[sampled_surface]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.4, 1.4);
  for (const auto& [name, corners] : hard_surfaces()) {
    INFO(name);
    const auto surface = std::make_shared<const TriangleSurface>(corners);
    REQUIRE(fault_of(*surface).empty());
    const TriangleDistance distance(surface, {});
    for (int n = 0; n < 4000; ++n) {
      Vec3 x{place(random), place(random), place(random)};
      if (n % 2 == 0) {  // near the surface, most of all near edges and corners
        const int k = n / 2 % surface->size();
        const double share = n % 4 == 0 ? 0 : 0.3;
        x = along(surface->corner(k, n / 3 % 3), share,
                  difference(surface->corner(k, 1), surface->corner(k, 0)));
        for (double& c : x) c += 0.02 * place(random);
      }
      double least = 1e300;
      for (int k = 0; k < surface->size(); ++k)
        least = std::min(least,
                         to_triangle(surface->corner(k, 0), surface->corner(k, 1), surface->corner(k, 2), x));
      const auto got = distance.nearest(x, n % 3 == 0 ? n % surface->size() : -1);
      CHECK(std::abs(std::abs(got.value) - least) < 1e-12);
      if (least > 1e-9) CHECK((got.value < 0) == surface->holds(x, 0));
    }
  }
}

TEST_CASE("samples of an stl give the distance of the shape that it is", "[sampled_surface]") {
  const MeshConfig mesh = mesh_of({-5, -5, -5}, {5, 5, 5}, 0.1);
  Shape block, ball_shape, plate, column;
  block.lower = {-0.41, -0.33, -0.57}, block.upper = {0.52, 0.61, 0.44};
  plate.lower = {-0.41, -0.33, 0}, plate.upper = {0.52, 0.61, 0.11};
  column.lower = {-0.4, -0.4, -5}, column.upper = {0.5, 0.6, 0.4};  // stands on the mesh's side
  ball_shape.kind = ShapeKind::disc, ball_shape.centre = {0.01, 0.02, 0.03}, ball_shape.radius = 0.5;
  struct Like {
    std::string name;
    std::vector<Vec3> corners;
    Shape shape;
    double value, normal;  // allowed: cells, -
  };
  const std::vector<Like> all{{"box", box(block.lower, block.upper), block, 0.06, 0.25},
                              {"plate", box(plate.lower, plate.upper), plate, 0.1, 0.35},
                              {"column", box(column.lower, column.upper), column, 0.06, 0.25},
                              {"ball", ball(ball_shape.centre, 0.5, 6), ball_shape, 0.01, 0.05}};
  std::mt19937 random(3);
  for (const Like& like : all) {
    INFO(like.name);
    const SurfaceInput exact = surface_input(like.shape, mesh, 3);
    const SurfaceInput in = surface_input(stl(like.corners), mesh, 3);
    REQUIRE(in.kind == SurfaceKind::sampled);
    const Surface<3> of_exact = surface_of<3>(exact, mesh.spacing), sampled = surface_of<3>(in, mesh.spacing);
    const Tables tables(in);
    const TriangleSurface surface(like.corners);
    double worst = 0, worst_normal = 0, mean = 0;
    int near = 0;
    for (int n = 0; n < 60000; ++n) {
      Vector<double, 3> x;
      for (int d = 0; d < 3; ++d) {
        const double low = std::max(surface.bounds().lower[d] - 0.4, mesh.lower[d]);
        x[d] = std::uniform_real_distribution<double>(low, surface.bounds().upper[d] + 0.4)(random) -
               mesh.lower[d];
      }
      const Distance<3> right = distance_to(of_exact, tables, x), got = distance_to(sampled, tables, x);
      if (std::abs(right.value) > 0.006) CHECK((got.value < 0) == (right.value < 0));
      if (right.value > 0.17) CHECK((got.value >= 0.12 && got.value < right.value + 0.04));
      if (right.value > 0.17 || right.value < -0.04) continue;
      double off = 0;
      for (int d = 0; d < 3; ++d) off += std::pow(got.normal[d] - right.normal[d], 2);
      if (right.value > 0) worst_normal = std::max(worst_normal, std::sqrt(off));
      worst = std::max(worst, std::abs(got.value - right.value) / mesh.spacing);
      mean += std::abs(got.value - right.value) / mesh.spacing, ++near;
    }
    CHECK(worst < like.value);
    CHECK(mean / near < like.value / 5);
    CHECK(worst_normal < like.normal);
  }
}

TEST_CASE("rounded edges of triangles are those of a box, and inner edges stay sharp", "[sampled_surface]") {
  const double radius = 0.05;
  const Vec3 low{-0.4, -0.3, -0.5}, high{0.5, 0.6, 0.4};
  const auto of_box = std::make_shared<const TriangleSurface>(box(low, high));
  const TriangleDistance sharp(of_box, {});
  const RoundedSurface rounded(sharp, radius);
  int guess = -1;
  const double s = std::sqrt(0.5), t = std::sqrt(1 / 3.0);
  const auto edge = rounded.at({high[0] + 0.02, 0.1, high[2] + 0.02}, guess);
  CHECK(std::abs(edge.value - (0.07 / s - radius)) < 1e-9);
  CHECK(edge.at_edge);
  CHECK(length_of(difference(edge.normal, {s, 0, s})) < 1e-9);
  const auto corner = rounded.at({high[0], high[1], high[2]}, guess);
  CHECK(std::abs(corner.value - (radius / t - radius)) < 1e-9);
  CHECK(length_of(difference(corner.normal, {t, t, t})) < 1e-9);
  const auto face = rounded.at({high[0] + 0.03, 0.1, 0.1}, guess);
  CHECK(std::abs(face.value - 0.03) < 1e-12);
  CHECK(!face.at_edge);
  CHECK(std::abs(rounded.at({high[0] - 0.2, 0.1, 0.1}, guess).value + 0.2) < 1e-12);

  const auto ell = std::make_shared<const TriangleSurface>(
      prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, -1}, {0, -1}}, -1, 1));
  const TriangleDistance sharp_ell(ell, {});
  const RoundedSurface rounded_ell(sharp_ell, radius);
  const auto inner = rounded_ell.at({0.1, 0, -0.02}, guess);
  CHECK(std::abs(inner.value - 0.02) < 1e-9);
  CHECK(length_of(difference(inner.normal, {0, 0, -1})) < 1e-9);
}

TEST_CASE("thin bodies of triangles are found, and edges and tips do not count", "[sampled_surface]") {
  const double most = 0.3;
  const auto of = [&](const std::vector<Vec3>& corners) {
    return thinnest_twentieth(*stl(corners).triangles, most);
  };
  const auto plate = of(box({0, 0, 0}, {2, 2, 0.1}));
  REQUIRE(plate);
  CHECK((plate->value >= 0.1 && plate->value <= 0.1 + most / 12 + 1e-12));
  CHECK(std::min(std::abs(plate->place[2]), std::abs(plate->place[2] - 0.1)) < 1e-12);
  CHECK_FALSE(of(box({0, 0, 0}, {1, 1, 1})));
  CHECK_FALSE(of(ball({0, 0, 0}, 1, 4)));
  // A fin on a block: a sixth of the surface is thin.
  std::vector<Vec3> both = box({0, 0, 0}, {1, 1, 1});
  const std::vector<Vec3> fin = box({2, 0, 0}, {2.05, 0.8, 0.8});
  both.insert(both.end(), fin.begin(), fin.end());
  const auto found = of(both);
  REQUIRE(found);
  CHECK((found->value < 0.1 && found->place[0] >= 2));
}

TEST_CASE("thin polygons are found, and corners do not count", "[sampled_surface]") {
  const double most = 0.25;
  const Point2 lower{-10, -10}, upper{10, 10};
  const auto thin = [&](Polygon polygon) {
    const bool found = is_thin(polygon, lower, upper, most);
    std::reverse(polygon.begin(), polygon.end());
    CHECK(is_thin(polygon, lower, upper, most) == found);
    return found;
  };
  CHECK(thin({{0, 0}, {2, 1.5}, {1.9, 1.65}, {-0.1, 0.15}}));             // a strip of 0.18 that leans
  CHECK_FALSE(thin({{0, 0}, {2, 1.5}, {1.82, 1.74}, {-0.18, 0.24}}));     // one of 0.3
  CHECK(thin({{0, 0}, {1, 0}, {1, 1}, {0.8, 1}, {0.8, 0.3}, {0, 0.3}}));  // the upright part of an L
  CHECK_FALSE(thin({{0, 0}, {1, 0}, {0.5, 0.87}}));
  CHECK_FALSE(thin({{0, 0}, {1, 0}, {1, 0.01}, {0.99, 0.02}, {0.98, 1}, {0, 1}}));
  // Half of a strip of 0.4 along its plane of symmetry, and one that goes on beyond the mesh.
  CHECK_FALSE(thin({{0, -10}, {1, -10}, {1, -9.8}, {0, -9.8}}));
  CHECK_FALSE(thin({{0, -11}, {1, -11}, {1, -9.8}, {0, -9.8}}));
}
