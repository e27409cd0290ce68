// The surfaces of cylinders and cones, against the nearest of many points of them.

#include <catch2/catch_test_macros.hpp>
#include <numbers>

#include "compare.hpp"
#include "input/geometry/revolved.hpp"
#include "physics/surface.hpp"
#include "step/surface_input.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

Shape shape_of(ShapeKind kind, double height, double tip, bool up) {
  Shape shape;
  shape.kind = kind, shape.centre = {0.3, -0.2, 0.1}, shape.radius = 0.5;
  shape.height = height, shape.tip_height = tip, shape.tip_up = up;
  return shape;
}

std::vector<Shape> revolved_shapes() {
  return {shape_of(ShapeKind::cylinder, 1.5, 0, false),   shape_of(ShapeKind::cylinder, 1.5, 0.8, false),
          shape_of(ShapeKind::cylinder, 0.8, 0.8, false), shape_of(ShapeKind::cone, 1.2, 0, false),
          shape_of(ShapeKind::cone, 1.2, 0, true),        shape_of(ShapeKind::cylinder, 1.5, 0.01, false)};
}

MeshConfig mesh_of(double spacing, double top = 5) {
  MeshConfig mesh;
  mesh.lower = {-5, -5, -5}, mesh.upper = {5, 5, top}, mesh.spacing = spacing;
  return mesh;
}

Distance<3> distance(const Shape& shape, const MeshConfig& mesh, const Vec3& x) {
  const SurfaceInput in = surface_input(shape, mesh, 3);
  const Kokkos::View<const Vertex*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> vertices(in.vertices.data(),
                                                                                         in.vertices.size());
  Vector<double, 3> from;
  for (int d = 0; d < 3; ++d) from[d] = x[d] - mesh.lower[d];
  return distance_to(surface_of<3>(in, mesh.spacing), vertices, from);
}

/// Points all over the surface, `apart` [m] or less.
std::vector<Vec3> points_of(const Shape& shape, double apart) {
  std::vector<Vec3> points;
  const Polygon section = section_of(shape, 0, 0);
  for (std::size_t k = 0; k < section.size(); ++k) {
    const Edge edge = edge_of(section, k);
    const double length = std::hypot(edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]);
    const int along = static_cast<int>(std::ceil(length / apart));
    for (int n = 0; n <= along; ++n) {
      const double t = double(n) / along, off = edge.from[0] + t * (edge.to[0] - edge.from[0]);
      const double z = edge.from[1] + t * (edge.to[1] - edge.from[1]);
      const int around = 1 + static_cast<int>(std::ceil(2 * std::numbers::pi * std::fabs(off) / apart));
      for (int m = 0; m < around && off >= 0; ++m) {
        const double turn = 2 * std::numbers::pi * m / around;
        points.push_back({shape.centre[0] + off * std::cos(turn), shape.centre[1] + off * std::sin(turn), z});
      }
    }
  }
  return points;
}

}  // namespace

TEST_CASE("distance and normal of a cylinder and a cone are those of the nearest point", "[surface]") {
  constexpr double k_apart = 0.02, k_rounding = 1e-3;  // m
  Dice dice{std::mt19937_64(21)};
  for (const Shape& shape : revolved_shapes()) {
    const auto points = points_of(shape, k_apart);
    const MeshConfig mesh = mesh_of(k_rounding);
    int inside = 0;
    double off = 0, turned = 0;
    for (int n = 0; n < 400; ++n) {
      const double wide = n % 2 == 0 ? 0.3 : 0.9;  // m, many of them inside
      const Vec3 x{0.3 + dice.uniform(-wide, wide), -0.2 + dice.uniform(-wide, wide), dice.uniform(-1.5, 2)};
      double nearest = 1e9;
      Vec3 to{};
      for (const Vec3& point : points) {
        const double length = std::hypot(x[0] - point[0], x[1] - point[1], x[2] - point[2]);
        if (length < nearest) nearest = length, to = point;
      }
      const bool holds = revolved_holds(shape, x, 0);
      const Distance<3> got = distance(shape, mesh, x);
      inside += holds;
      if ((got.value < 0) != holds && std::fabs(got.value) > 2 * k_rounding) FAIL_CHECK("side " << got.value);
      off = std::max(off, std::fabs(std::fabs(got.value) - nearest));
      if (nearest < 0.2 || holds) continue;  // further off the points are as good as the surface
      double cosine = 0;
      for (int d = 0; d < 3; ++d) cosine += got.normal[d] * (x[d] - to[d]) / nearest;
      turned = std::max(turned, 1 - cosine);
    }
    CHECK(inside > 10);
    CHECK(off < 0.5 * k_apart);
    CHECK(turned < 0.01);
  }
}

TEST_CASE("the normal of a cylinder and a cone is the slope of the distance, of length 1", "[surface]") {
  Dice dice{std::mt19937_64(22)};
  constexpr double k_step = 1e-6;
  for (const Shape& shape : revolved_shapes()) {
    const MeshConfig mesh = mesh_of(0.1);
    int bent = 0;
    for (int n = 0; n < 1000; ++n) {
      const Vec3 x{dice.uniform(-0.6, 1.2), dice.uniform(-1.1, 0.7), dice.uniform(-1.5, 2)};
      const Distance<3> got = distance(shape, mesh, x);
      double error = std::fabs(dot(got.normal, got.normal) - 1);
      for (int d = 0; d < 3; ++d) {
        Vec3 low = x, high = x;
        low[d] -= k_step, high[d] += k_step;
        const double slope =
            (distance(shape, mesh, high).value - distance(shape, mesh, low).value) / (2 * k_step);
        error = std::max(error, std::fabs(slope - got.normal[d]));
      }
      bent += error > 1e-4;
    }
    CHECK(bent < 10);  // where two parts are equally near
  }
}

TEST_CASE("a cylinder or cone that ends at the mesh's side goes on beyond it, as a cylinder", "[surface]") {
  for (const Shape& shape :
       {shape_of(ShapeKind::cylinder, 1.5, 0.8, false), shape_of(ShapeKind::cone, 1.5, 0, false)}) {
    const double top = ends_of(shape)[1];
    const Distance<3> ends = distance(shape, mesh_of(0.1), {0.3, -0.2, top - 0.01}),
                      goes_on = distance(shape, mesh_of(0.1, top), {0.3, -0.2, top - 0.01});
    CHECK(std::fabs(ends.value + 0.01) < 1e-12);
    CHECK(goes_on.value < -0.2);
    CHECK(std::fabs(distance(shape, mesh_of(0.1, top), {1.8, -0.2, top + 3}).value - 1) < 1e-12);
  }
}

TEST_CASE("on the axis a cylinder or cone has a normal along it, or none next to the shaft alone",
          "[surface]") {
  for (const Shape& shape : revolved_shapes()) {
    const MeshConfig mesh = mesh_of(0.01);
    for (double z = ends_of(shape)[0] - 0.5; z < ends_of(shape)[1] + 0.5; z += 0.07) {
      const auto at = [&](double dx, double dy) {
        return distance(shape, mesh, {shape.centre[0] + dx, shape.centre[1] + dy, z}).normal;
      };
      const auto on_axis = at(0, 0), round_off = at(1e-17, -1e-17), aside = at(1e-4, 0);
      const bool along = std::fabs(aside[2]) > 1e-6;
      CHECK(std::fabs(on_axis[2] - (along ? std::copysign(1., aside[2]) : 0)) < 1e-12);
      for (int d = 0; d < 3; ++d) CHECK(on_axis[d] == round_off[d]);
      for (int d = 0; d < 2; ++d) CHECK(on_axis[d] == 0);
    }
  }
}

TEST_CASE("no tip recedes by more than half a cell when corners are rounded", "[surface]") {
  for (const double height : {0.1, 0.5, 2., 20.}) {
    Shape shape = shape_of(ShapeKind::cone, height, 0, false);
    const double tip = distance(shape, mesh_of(0.1), shape.centre).value;
    CHECK(tip > 0);
    CHECK(tip < 0.05 + 1e-12);
  }
}
