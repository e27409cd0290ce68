#include "step/surface_input.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/height_surface.hpp"
#include "input/geometry/revolved.hpp"
#include "input/geometry/united.hpp"
#include "step/sample_surface.hpp"

namespace mpm {
namespace {

constexpr double k_slack = 1e-6;  // of the mesh spacing: closer to the mesh's boundary is on it

/// How far a body that ends on the mesh's boundary goes on beyond it [m]: further than any point of the mesh
/// is from another face of the body, so that the end beyond the mesh is the nearest face nowhere, in a mesh
/// of one cell across neither.
double beyond_mesh(const MeshConfig& mesh, int dim) {
  double sum = 0;
  for (int d = 0; d < dim; ++d) sum += mesh.upper[d] - mesh.lower[d];
  return sum;
}

/// Whether an edge lies on the mesh's boundary, beyond which the body goes on.
bool on_boundary(const Edge& edge, const MeshConfig& mesh, int dim) {
  const double slack = k_slack * mesh.spacing;
  bool on = false;
  for (int k = 0; k < 2; ++k) {
    const int d = k == 0 ? 0 : dim - 1;
    for (const double side : {mesh.lower[d], mesh.upper[d]})
      on = on || (std::abs(edge.from[k] - side) < slack && std::abs(edge.to[k] - side) < slack);
  }
  return on;
}

/// Radius [m] that corners of a polygon, anticlockwise, can be rounded by: half a cell, but no corner recedes
/// by more than that, and no edge loses more than a share of its length. Corners that point into the body
/// stay sharp. ends[k]: edge k lies on a side of the mesh and is no surface; a corner there is that with the
/// image.
double rounding_of(const Polygon& polygon, const std::vector<bool>& ends, double share, double spacing) {
  const double most = spacing / 2;
  double radius = most;
  const std::size_t count = polygon.size();
  const auto half_turn = [&](std::size_t k) {  // at vertex k, rad; 0 where there is nothing to round
    const std::size_t before = (k + count - 1) % count;
    if (ends[before] && ends[k]) return 0.0;
    const Edge in = edge_of(polygon, before), out = edge_of(polygon, k);
    const double ax = in.to[0] - in.from[0], ay = in.to[1] - in.from[1], bx = out.to[0] - out.from[0],
                 by = out.to[1] - out.from[1];
    const double turn = std::atan2(ax * by - ay * bx, ax * bx + ay * by);
    return std::max(0.0, ends[before] || ends[k] ? turn - M_PI / 2 : turn / 2);
  };
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t next = (k + 1) % count;
    const double recedes = 1 / std::cos(half_turn(k)) - 1;
    const double lost = std::tan(half_turn(k)) + std::tan(half_turn(next));
    const double length = std::hypot(polygon[next][0] - polygon[k][0], polygon[next][1] - polygon[k][1]);
    if (recedes > 1) radius = std::min(radius, most / recedes);
    if (radius * lost > share * length) radius = share * length / lost;
  }
  return radius;
}

/// Its edges moved inwards by a radius [m], but those that are no surface.
Polygon made_smaller(const Polygon& polygon, const std::vector<bool>& ends, double radius) {
  const std::size_t count = polygon.size();
  const auto inward = [&](std::size_t k) {
    const Edge edge = edge_of(polygon, k);
    const double x = edge.to[0] - edge.from[0], y = edge.to[1] - edge.from[1], length = std::hypot(x, y);
    return Point2{-y / length, x / length};
  };
  Polygon smaller;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t before = (k + count - 1) % count;
    const Point2 a = inward(before), b = inward(k);
    const double by_a = ends[before] ? 0 : radius, by_b = ends[k] ? 0 : radius;
    const double cosine = a[0] * b[0] + a[1] * b[1], square = 1 - cosine * cosine;
    constexpr double k_straight = 1e-9;  // sine squared, less is one line, or an edge that turns back
    const double of_a = square > k_straight ? (by_a - cosine * by_b) / square : by_a / 2,
                 of_b = square > k_straight ? (by_b - cosine * by_a) / square : by_b / 2;
    Point2 vertex{polygon[k][0] + of_a * a[0] + of_b * b[0], polygon[k][1] + of_a * a[1] + of_b * b[1]};
    for (const auto& [end, normal] : {std::pair{ends[before], a}, {ends[k], b}}) {
      const int across = std::abs(normal[0]) > std::abs(normal[1]) ? 0 : 1;
      if (end) vertex[across] = polygon[k][across];  // a node on the side is not beyond it by round-off
    }
    smaller.push_back(vertex);
  }
  return smaller;
}

SurfaceInput box(const Shape& shape, const MeshConfig& mesh, int dim, Corners corners) {
  SurfaceInput out;
  const double slack = k_slack * mesh.spacing;
  Vec3 lower = shape.lower, upper = shape.upper;
  double shortest = upper[0] - lower[0];
  for (int d = 1; d < dim; ++d) shortest = std::min(shortest, upper[d] - lower[d]);
  for (int d = 0; d < dim && shape.angle == 0; ++d) {
    if (lower[d] < mesh.lower[d] + slack) lower[d] -= beyond_mesh(mesh, dim);
    if (upper[d] > mesh.upper[d] - slack) upper[d] += beyond_mesh(mesh, dim);
  }
  for (int d = 0; d < dim; ++d) {
    out.half[d] = (upper[d] - lower[d]) / 2;
    out.centre[d] = (upper[d] + lower[d]) / 2 - mesh.lower[d];
  }
  out.angle = shape.angle;
  if (shape.angle != 0) {
    const int up = dim - 1;
    out.centre[0] = lower[0] + std::cos(out.angle) * out.half[0] - std::sin(out.angle) * out.half[up];
    out.centre[up] = lower[up] + std::sin(out.angle) * out.half[0] + std::cos(out.angle) * out.half[up];
    out.centre[0] -= mesh.lower[0], out.centre[up] -= mesh.lower[up];
  }
  constexpr double k_rounding = 0.5;  // cells
  const double least = corners == Corners::rounded ? std::min(k_rounding * mesh.spacing, shortest / 2) : 0;
  out.radius = std::max(shape.fillet, least);
  return out;
}

SurfaceInput polygon(const Shape& shape, const MeshConfig& mesh, int dim, Corners corners) {
  SurfaceInput out;
  out.kind = SurfaceKind::polygon;
  const double slack = k_slack * mesh.spacing;
  Polygon outline = shape.polygon;
  if (signed_area_of(outline) < 0) std::reverse(outline.begin(), outline.end());
  std::vector<bool> ends;
  for (std::size_t k = 0; k < outline.size(); ++k)
    ends.push_back(on_boundary(edge_of(outline, k), mesh, dim));
  constexpr double k_left = 1e-6;  // of an edge, so that none vanishes
  if (corners == Corners::rounded) out.radius = rounding_of(outline, ends, 1 - k_left, mesh.spacing);
  if (dim == 3) out.radius = std::min(out.radius, (shape.width[1] - shape.width[0]) / 2);
  const Polygon smaller = made_smaller(outline, ends, out.radius);
  for (std::size_t k = 0; k < smaller.size(); ++k)
    out.vertices.push_back({smaller[k][0] - mesh.lower[0], smaller[k][1] - mesh.lower[dim - 1], ends[k]});
  if (dim == 3) {
    double low = shape.width[0], high = shape.width[1];
    if (low < mesh.lower[1] + slack) low -= beyond_mesh(mesh, dim);
    if (high > mesh.upper[1] - slack) high += beyond_mesh(mesh, dim);
    out.half[1] = (high - low) / 2;
    out.centre[1] = (high + low) / 2 - mesh.lower[1];
  }
  return out;
}

bool depends_on_y(const Shape& layer) {
  return !layer.top->lines(1).empty() || !layer.base->lines(1).empty();
}

/// The outline of a layer whose surfaces do not depend on y.
Shape prism_of(const Shape& layer, const MeshConfig& mesh) {
  Shape prism;
  prism.kind = ShapeKind::polygon;
  prism.width = {mesh.lower[1], mesh.upper[1]};
  const auto add = [&](const HeightSurface& surface, bool forward) {
    std::vector<double> x{mesh.lower[0]};
    for (const double line : surface.lines(0))
      if (line > mesh.lower[0] && line < mesh.upper[0]) x.push_back(line);
    x.push_back(mesh.upper[0]);
    if (!forward) std::reverse(x.begin(), x.end());
    for (const double at : x) {
      const Point2 vertex{at, surface.at(at, 0)};
      if (prism.polygon.empty() || (prism.polygon.back() != vertex && prism.polygon.front() != vertex))
        prism.polygon.push_back(vertex);
    }
  };
  add(*layer.base, true);
  add(*layer.top, false);
  return prism;
}

/// The ground under the top of a layer, by its heights over the mesh's nodes.
SurfaceInput heights(const HeightSurface& top, const MeshConfig& mesh) {
  SurfaceInput out;
  out.kind = SurfaceKind::heights;
  out.radius = mesh.spacing;
  out.columns = mesh.cells[0] + 1;
  for (int j = 0; j <= mesh.cells[1]; ++j)
    for (int i = 0; i <= mesh.cells[0]; ++i) {
      const double x = mesh.lower[0] + i * mesh.spacing, y = mesh.lower[1] + j * mesh.spacing;
      out.vertices.push_back({x - mesh.lower[0], top.at(x, y) - mesh.lower[2], false});
    }
  return out;
}

SurfaceInput layer(const Shape& shape, const MeshConfig& mesh, int dim, Corners corners) {
  if (dim == 2 || !depends_on_y(shape)) return polygon(prism_of(shape, mesh), mesh, dim, corners);
  return heights(*shape.top, mesh);
}

SurfaceInput revolved(const Shape& shape, const MeshConfig& mesh, Corners corners) {
  SurfaceInput out;
  out.kind = SurfaceKind::revolved;
  const double slack = k_slack * mesh.spacing, beyond = beyond_mesh(mesh, 3);
  const auto [low, high] = ends_of(shape);
  const Polygon section =
      section_of(shape, low < mesh.lower[2] + slack ? beyond : 0, high > mesh.upper[2] - slack ? beyond : 0);
  const std::vector<bool> all(section.size(), false);
  if (corners == Corners::rounded) out.radius = rounding_of(section, all, 0.5, mesh.spacing);
  for (const Point2& vertex : made_smaller(section, all, out.radius))
    out.vertices.push_back({vertex[0], vertex[1] - shape.centre[2], false});
  for (int d = 0; d < 3; ++d) out.centre[d] = shape.centre[d] - mesh.lower[d];
  return out;
}

}  // namespace

SurfaceInput surface_input(const Shape& shape, const MeshConfig& mesh, int dim, Corners corners) {
  if (shape.kind == ShapeKind::box) return box(shape, mesh, dim, corners);
  if (shape.kind == ShapeKind::polygon) return polygon(shape, mesh, dim, corners);
  if (is_revolved(shape)) return revolved(shape, mesh, corners);
  if (shape.kind == ShapeKind::layer) return layer(shape, mesh, dim, corners);
  if (shape.kind == ShapeKind::parts) {
    SurfaceInput all;
    all.kind = SurfaceKind::parts;
    for (const Shape& part : grown_parts(shape, mesh, dim))
      all.parts.push_back(surface_input(part, mesh, dim, corners));
    return all;
  }
  if (shape.kind == ShapeKind::stl && corners == Corners::rounded) return sampled_surface(shape, mesh);
  SurfaceInput out;
  if (shape.kind == ShapeKind::stl) {
    out.kind = SurfaceKind::sampled;
    return out;
  }
  out.kind = shape.kind == ShapeKind::disc ? SurfaceKind::disc : SurfaceKind::half_plane;
  const Vec3& centre = shape.kind == ShapeKind::disc ? shape.centre : shape.point;
  for (int d = 0; d < dim; ++d) out.centre[d] = centre[d] - mesh.lower[d];
  out.normal = shape.normal;
  out.radius = shape.radius;
  return out;
}

}  // namespace mpm
