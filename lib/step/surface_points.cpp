#include "step/surface_points.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/region.hpp"
#include "input/geometry/shapes.hpp"
#include "input/geometry/triangle_points.hpp"
#include "input/geometry/vectors.hpp"
#include "step/surface_input.hpp"

namespace mpm {
namespace {

constexpr double k_apart = 0.5;    // cells, between points of a surface at most
constexpr double k_inward = 0.05;  // cells, from a point to the place inside at most
constexpr double k_thin = 0.05;    // of the shortest edge of the bounds, likewise

/// Points of a surface that are in the mesh.
class PointsInMesh {
 public:
  /// inward [m]: way from a point to the place inside; radius [m]: of the sphere around each point that comes
  /// without.
  PointsInMesh(const Config& config, double inward, double radius, SurfacePoints& to)
      : mesh_(config.mesh), dim_(config.dim), inward_(inward), radius_(radius), to_(to) {}

  /// x, from the mesh's lower corner [m]; inward: each component a multiple of the way inward.
  void add(const Vec3& x, const Vec3& inward) { add(x, inward, radius_); }
  void add(const Vec3& x, Vec3 inward, double radius) {
    for (int d = 0; d < dim_; ++d) {
      const double slack = k_flush * mesh_.spacing;
      if (x[d] < -slack || x[d] > mesh_.upper[d] - mesh_.lower[d] + slack) return;
      inward[d] *= inward_;
    }
    to_.points.push_back(x), to_.inward.push_back(inward), to_.radius.push_back(radius);
  }
  /// Places between two ends of a line, without them, as shares of its length [m].
  std::vector<double> between(double length) const {
    const int parts = static_cast<int>(std::ceil(length / (k_apart * mesh_.spacing) - 1e-9));
    std::vector<double> out;
    for (int n = 1; n < parts; ++n) out.push_back(static_cast<double>(n) / parts);
    return out;
  }

 private:
  const MeshConfig& mesh_;
  int dim_;
  double inward_, radius_;
  SurfacePoints& to_;
};

/// Corners, edges and, of bodies that move, faces of a box. The core of a rounded box has them.
void add_box(const SurfaceInput& box, int dim, bool faces, PointsInMesh& to) {
  const double cosine = std::cos(box.angle), sine = std::sin(box.angle);
  const auto turned = [&](const Vec3& v) {
    Vec3 out = v;
    const int up = dim - 1;
    out[0] = cosine * v[0] - sine * v[up], out[up] = sine * v[0] + cosine * v[up];
    return out;
  };
  Vec3 half{};
  for (int d = 0; d < dim; ++d) half[d] = std::max(0.0, box.half[d] - box.radius);
  // Along each axis the two ends, and what is between them.
  std::array<std::vector<double>, 3> at;
  for (int d = 0; d < dim; ++d) {
    at[d] = {-1, 1};
    for (const double share : to.between(2 * half[d])) at[d].push_back(2 * share - 1);
  }
  if (dim == 2) at[2] = {0};
  const int most_between = faces ? dim - 1 : dim - 2;
  for (int inner = 0; inner <= most_between; ++inner)  // corners first, then edges, then faces
    for (const double z : at[2])
      for (const double y : at[1])
        for (const double x : at[0]) {
          const Vec3 place{x, y, z};
          Vec3 point{}, inward{};
          int between = 0;
          for (int d = 0; d < dim; ++d) {
            point[d] = place[d] * half[d];
            const bool end = std::abs(place[d]) == 1;
            inward[d] = end ? -place[d] : 0;
            between += !end;
          }
          if (between != inner) continue;
          point = turned(point);
          for (int d = 0; d < dim; ++d) point[d] += box.centre[d];
          to.add(point, turned(inward));
        }
}

/// Way inward at a vertex of a polygon, as far from both edges; nothing at a corner that points inwards.
std::optional<std::array<double, 2>> inward_at(const std::vector<Vertex>& polygon, std::size_t k,
                                               double turn) {
  const std::size_t count = polygon.size();
  const Vertex &a = polygon[(k + count - 1) % count], &b = polygon[k], &c = polygon[(k + 1) % count];
  const auto normal = [&](const Vertex& from, const Vertex& to) {
    const double x = to.x - from.x, z = to.z - from.z, length = std::hypot(x, z);
    return std::array<double, 2>{-turn * z / length, turn * x / length};  // inward
  };
  const auto m = normal(a, b), n = normal(b, c);
  const double corner = turn * ((b.x - a.x) * (c.z - b.z) - (b.z - a.z) * (c.x - b.x));
  if (corner <= 0) return {};
  constexpr double k_most = 3;
  const double scale = std::min(1 / (1 + m[0] * n[0] + m[1] * n[1] + 1e-12),
                                k_most / (std::hypot(m[0] + n[0], m[1] + n[1]) + 1e-12));
  return std::array<double, 2>{scale * (m[0] + n[0]), scale * (m[1] + n[1])};
}

/// Vertices and, of bodies that move, edges of a polygon; in 3D those of both ends of the prism, and its
/// edges along y.
void add_polygon(const SurfaceInput& polygon, int dim, bool faces, PointsInMesh& to) {
  const auto& v = polygon.vertices;
  double twice_area = 0;
  for (std::size_t k = 0; k < v.size(); ++k) {
    const Vertex& next = v[(k + 1) % v.size()];
    twice_area += v[k].x * next.z - next.x * v[k].z;
  }
  const double turn = twice_area < 0 ? -1 : 1;
  std::vector<double> across{0};  // along y, shares of half the width
  if (dim == 3) {
    across = {-1, 1};
    for (const double share : to.between(2 * polygon.half[1])) across.push_back(2 * share - 1);
  }
  const auto add = [&](double x, double z, double y, const std::array<double, 2>& inward) {
    const bool end = std::abs(y) == 1;
    if (dim == 2)
      to.add({x, z, 0}, {inward[0], inward[1], 0});
    else
      to.add({x, polygon.centre[1] + y * polygon.half[1], z}, {inward[0], end ? -y : 0, inward[1]});
  };
  for (const double y : across)
    for (std::size_t k = 0; k < v.size(); ++k) {
      if (const auto inward = inward_at(v, k, turn)) add(v[k].x, v[k].z, y, *inward);
      const Vertex& next = v[(k + 1) % v.size()];
      const double x = next.x - v[k].x, z = next.z - v[k].z, length = std::hypot(x, z);
      if (!(dim == 3 ? std::abs(y) == 1 || faces : faces) || v[k].outside) continue;
      for (const double share : to.between(length))
        add(v[k].x + share * x, v[k].z + share * z, y, {-turn * z / length, turn * x / length});
    }
}

/// Rims of a body that turns about the vertical axis, and its tips.
void add_revolved(const SurfaceInput& body, const Shape& shape, const MeshConfig& mesh, PointsInMesh& to) {
  constexpr int k_least = 16;
  const double middle = (bounds_of(shape, mesh, 3).lower[2] + bounds_of(shape, mesh, 3).upper[2]) / 2;
  for (const Vertex& v : body.vertices) {
    const double z = body.centre[2] + v.z, up = z + mesh.lower[2] < middle ? 1 : -1;
    if (v.x < -1e-9 * mesh.spacing) continue;
    const int count = v.x > 1e-9 * mesh.spacing
                          ? std::max(k_least, static_cast<int>(to.between(2 * M_PI * v.x).size()) + 1)
                          : 1;
    for (int n = 0; n < count; ++n) {
      const double angle = 2 * M_PI * n / count, x = std::cos(angle), y = std::sin(angle), off = count > 1;
      to.add({body.centre[0] + v.x * x, body.centre[1] + v.x * y, z}, {-off * x, -off * y, up});
    }
  }
}

/// Points of triangles: of those with a ball, its centre.
void add_triangles(const Shape& shape, const MeshConfig& mesh, bool faces, PointsInMesh& to) {
  for (const TrianglePoint& point : triangle_points(shape.triangles, k_apart * mesh.spacing, faces))
    to.add(difference(along(point.x, -point.radius, point.normal), mesh.lower), along({}, -1, point.normal),
           point.radius);
}

/// Points of one part of a body.
void add_part(const Config& config, const Shape& shape, bool faces, SurfacePoints& to) {
  const MeshConfig& mesh = config.mesh;
  const int dim = config.dim;
  const SurfaceInput surface = surface_input(shape, mesh, dim, Corners::sharp);
  if (surface.kind == SurfaceKind::disc) {
    to.points.push_back(surface.centre), to.inward.push_back({}), to.radius.push_back(shape.radius);
    return;
  }
  const Bounds bounds = bounds_of(shape, mesh, dim);
  double thinnest = HUGE_VAL;
  for (int d = 0; d < dim; ++d) thinnest = std::min(thinnest, bounds.upper[d] - bounds.lower[d]);
  const bool box = surface.kind == SurfaceKind::box;
  PointsInMesh points(config, std::min(k_inward * mesh.spacing, k_thin * thinnest), box ? surface.radius : 0,
                      to);
  if (box)
    add_box(surface, dim, faces, points);
  else if (surface.kind == SurfaceKind::polygon)
    add_polygon(surface, dim, faces, points);
  else if (surface.kind == SurfaceKind::revolved)
    add_revolved(surface, shape, mesh, points);
  else if (surface.kind == SurfaceKind::sampled)
    add_triangles(shape, mesh, faces, points);
}

/// Leaves out the points of part n that are on no surface of the union: a step outwards leads into another
/// part.
void add_uncovered(const Config& config, const Shape& shape, std::size_t n, const SurfacePoints& from,
                   SurfacePoints& to) {
  constexpr double k_step = 0.02;  // cells
  std::vector<Region> others;
  for (std::size_t m = 0; m < shape.parts.size(); ++m)
    if (m != n) others.emplace_back(shape.parts[m], config.dim, 0);
  for (std::size_t p = 0; p < from.points.size(); ++p) {
    const double length = length_of(from.inward[p]);
    Vec3 x = along(config.mesh.lower, 1, from.points[p]);
    if (length > 0) x = along(x, -(from.radius[p] + k_step * config.mesh.spacing) / length, from.inward[p]);
    const bool covered = length > 0 && std::any_of(others.begin(), others.end(), [&](Region& other) {
                           other.enter_row(x[config.dim - 1], x[config.dim - 1]);
                           return other.holds(x);
                         });
    if (covered) continue;
    to.points.push_back(from.points[p]), to.inward.push_back(from.inward[p]);
    to.radius.push_back(from.radius[p]);
  }
}

}  // namespace

SurfacePoints surface_points(const Config& config, const Shape& shape, bool faces) {
  SurfacePoints points;
  if (shape.kind != ShapeKind::parts) add_part(config, shape, faces, points);
  for (std::size_t n = 0; n < shape.parts.size(); ++n) {
    SurfacePoints own;
    add_part(config, shape.parts[n], faces, own);
    add_uncovered(config, shape, n, own, points);
  }
  return points;
}

}  // namespace mpm
