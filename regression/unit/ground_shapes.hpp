#pragma once
// Surfaces of triangles and layers for tests.

#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "input/files/raster_file.hpp"
#include "input/geometry/triangle_surface.hpp"

namespace mpm::test {

using Corners = std::vector<Vec3>;

inline MeshConfig mesh_of(Vec3 lower, Vec3 upper, double spacing) {
  MeshConfig mesh;
  mesh.lower = lower, mesh.upper = upper, mesh.spacing = spacing;
  return mesh;
}

/// Corners of triangles that are 4^halvings as many as those of an octahedron, on a ball.
inline Corners ball(const Vec3& centre, double radius, int halvings) {
  Corners corners;
  for (int o = 0; o < 8; ++o) {
    const double x = o & 1 ? -1 : 1, y = o & 2 ? -1 : 1, z = o & 4 ? -1 : 1;
    const bool odd = (o & 1) ^ (o >> 1 & 1) ^ (o >> 2 & 1);
    Corners face{{x, 0, 0}, {0, y, 0}, {0, 0, z}};
    if (odd) std::swap(face[0], face[1]);
    corners.insert(corners.end(), face.begin(), face.end());
  }
  const auto middle = [](const Vec3& a, const Vec3& b) {
    Vec3 m{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    const double length = std::hypot(m[0], m[1], m[2]);
    return Vec3{m[0] / length, m[1] / length, m[2] / length};
  };
  for (int h = 0; h < halvings; ++h) {
    Corners finer;
    for (std::size_t k = 0; k < corners.size(); k += 3) {
      const Vec3 &a = corners[k], &b = corners[k + 1], &c = corners[k + 2], p = middle(a, b),
                 q = middle(b, c), r = middle(c, a);
      for (const Vec3& x : {a, p, r, p, b, q, r, q, c, p, q, r}) finer.push_back(x);
    }
    corners = finer;
  }
  for (Vec3& x : corners)
    for (int d = 0; d < 3; ++d) x[d] = centre[d] + radius * x[d];
  return corners;
}

/// Two triangles a face.
inline Corners box(const Vec3& low, const Vec3& high) {
  Corners corners;
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      Vec3 x[4];
      for (int k = 0; k < 4; ++k) {
        x[k][d] = side ? high[d] : low[d];
        x[k][e] = k == 1 || k == 2 ? high[e] : low[e];
        x[k][f] = k >= 2 ? high[f] : low[f];
      }
      for (const int k : {0, 1, 2, 0, 2, 3}) corners.push_back(x[side ? k : (4 - k) % 4]);
    }
  return corners;
}

inline Corners turned_at_random(Corners corners, const Vec3& about, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  for (int d = 0; d < 3; ++d) {
    const double c = std::cos(angle(random)), s = std::sqrt(1 - c * c);
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    for (Vec3& x : corners) {
      const double a = x[e] - about[e], b = x[f] - about[f];
      x[e] = about[e] + c * a - s * b, x[f] = about[f] + s * a + c * b;
    }
  }
  return corners;
}

inline Shape stl(const Corners& corners) {
  Shape shape;
  shape.kind = ShapeKind::stl, shape.fill = Fill::cut;
  shape.triangles = std::make_shared<const TriangleSurface>(corners);
  return shape;
}

inline std::shared_ptr<const HeightSurface> level(double z) {
  return std::make_shared<const HeightSurface>(z);
}
inline std::shared_ptr<const HeightSurface> polyline(std::vector<double> x, std::vector<double> z) {
  return std::make_shared<const HeightSurface>(std::move(x), std::vector<double>{}, std::move(z));
}
template <class Height>
std::shared_ptr<const HeightSurface> raster(double x, double y, double cell, long columns, long rows,
                                            Height&& f) {
  Raster raster{columns, rows, x, y, cell, {}};
  for (long j = 0; j < rows; ++j)
    for (long i = 0; i < columns; ++i) raster.values.push_back(f(x + (i + 0.5) * cell, y + (j + 0.5) * cell));
  return surface_of(raster);
}

inline Shape layer(std::shared_ptr<const HeightSurface> top, std::shared_ptr<const HeightSurface> base) {
  Shape shape;
  shape.kind = ShapeKind::layer, shape.fill = Fill::cut, shape.top = top, shape.base = base;
  return shape;
}

constexpr double k_ball = 4 * std::numbers::pi / 3;  // volume of one of radius 1

}  // namespace mpm::test
