// Volumes and bounds of shapes.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "input/geometry/facets.hpp"
#include "input/geometry/polygon.hpp"
#include "input/geometry/region.hpp"
#include "input/geometry/revolved.hpp"
#include "input/geometry/round_volume.hpp"
#include "input/geometry/shapes.hpp"
#include "input/geometry/thickness.hpp"
#include "input/geometry/united.hpp"

namespace mpm {
namespace {

/// The box made smaller by its fillet, and all within the fillet of it (Steiner's formula). Where the mesh
/// cuts it, an end has no fillet: `ends` are those that do.
double box_volume(const Shape& shape, const MeshConfig& mesh, int dim) {
  constexpr double k_pi = std::numbers::pi;
  const double r = shape.fillet, slack = 1e-9 * mesh.spacing;
  Vec3 e{}, ends{2, 2, 2};
  for (int d = 0; d < dim; ++d) {
    double low = shape.lower[d] + r, high = shape.upper[d] - r;
    if (shape.angle == 0 && shape.lower[d] < mesh.lower[d] - slack) low = mesh.lower[d], --ends[d];
    if (shape.angle == 0 && shape.upper[d] > mesh.upper[d] + slack) high = mesh.upper[d], --ends[d];
    e[d] = std::max(0.0, high - low);
  }
  if (dim == 2)
    return e[0] * e[1] + r * (ends[0] * e[1] + ends[1] * e[0]) + k_pi / 4 * r * r * ends[0] * ends[1];
  double volume = e[0] * e[1] * e[2] + k_pi / 6 * r * r * r * ends[0] * ends[1] * ends[2];
  for (int d = 0; d < 3; ++d) {
    const int a = (d + 1) % 3, b = (d + 2) % 3;
    volume += r * ends[d] * e[a] * e[b] + k_pi / 4 * r * r * ends[a] * ends[b] * e[d];
  }
  return volume;
}

/// Part of the mesh behind a plane. With a_d how far the normal component of x grows across the mesh in
/// direction d, and t its distance from the corner furthest behind to the face, the share of m directions is
///   sum over all sets S of them of (-1)^|S| max(0, t - sum of a in S)^m / (m! product of all a).
double part_behind(const Shape& shape, const MeshConfig& mesh, int dim) {
  constexpr double k_flat =
      1e-4;  // of the largest a: such a direction counts by its middle, lest differences
             // of large numbers be divided by it (error of the share below 1e-8)
  Vec3 growth{};
  double volume = 1, offset = 0;
  for (int d = 0; d < dim; ++d) {
    const double extent = mesh.upper[d] - mesh.lower[d],
                 deepest = shape.normal[d] > 0 ? mesh.lower[d] : mesh.upper[d];
    volume *= extent;
    growth[d] = std::abs(shape.normal[d]) * extent;
    offset += shape.normal[d] * (shape.point[d] - deepest);
  }
  const double largest = *std::max_element(growth.begin(), growth.end());
  std::vector<double> steep;
  double total = 0;
  for (int d = 0; d < dim; ++d) {
    if (growth[d] > k_flat * largest)
      steep.push_back(growth[d]), total += growth[d];
    else
      offset -= growth[d] / 2;
  }
  const int m = static_cast<int>(steep.size());
  offset = std::clamp(offset, 0.0, total);
  double share = 0;
  for (int set = 0; set < 1 << m; ++set) {
    double left = offset, sign = 1;
    for (int k = 0; k < m; ++k)
      if (set >> k & 1) left -= steep[k], sign = -sign;
    share += sign * std::pow(std::max(left, 0.0), m);
  }
  for (int k = 0; k < m; ++k) share /= (k + 1) * steep[k];
  return share * volume;
}

/// Bounds of the corners of the box made smaller by its fillet, turned; the fillet reaches out from them.
Bounds box_bounds(const Shape& shape, int dim) {
  constexpr double k_far = std::numeric_limits<double>::max();
  Bounds bounds;
  for (int d = 0; d < dim; ++d) bounds.lower[d] = k_far, bounds.upper[d] = -k_far;
  for (int k = 0; k < 1 << dim; ++k) {
    Vec3 x{};
    for (int d = 0; d < dim; ++d)
      x[d] = k >> d & 1 ? shape.upper[d] - shape.fillet : shape.lower[d] + shape.fillet;
    x = turned(x, shape.lower, shape.angle, dim);
    for (int d = 0; d < dim; ++d) {
      bounds.lower[d] = std::min(bounds.lower[d], x[d] - shape.fillet);
      bounds.upper[d] = std::max(bounds.upper[d], x[d] + shape.fillet);
    }
  }
  return bounds;
}

Bounds prism_bounds(const Shape& shape, int dim) {
  Bounds bounds;
  if (dim == 3) bounds.lower[1] = shape.width[0], bounds.upper[1] = shape.width[1];
  for (int c = 0; c < 2; ++c) {
    const auto [low, high] =
        std::minmax_element(shape.polygon.begin(), shape.polygon.end(),
                            [c](const Point2& a, const Point2& b) { return a[c] < b[c]; });
    const int d = c == 0 ? 0 : dim - 1;
    bounds.lower[d] = (*low)[c], bounds.upper[d] = (*high)[c];
  }
  return bounds;
}

Bounds ball_bounds(const Shape& shape, int dim) {
  Bounds bounds;
  for (int d = 0; d < dim; ++d)
    bounds.lower[d] = shape.centre[d] - shape.radius, bounds.upper[d] = shape.centre[d] + shape.radius;
  return bounds;
}

Bounds revolved_bounds(const Shape& shape) {
  Bounds bounds = ball_bounds(shape, 2);
  bounds.lower[2] = ends_of(shape)[0], bounds.upper[2] = ends_of(shape)[1];
  return bounds;
}

/// In each direction as far as any point of the mesh is behind the plane.
Bounds behind_bounds(const Shape& shape, const MeshConfig& mesh, int dim) {
  Bounds bounds{mesh.lower, mesh.upper};
  for (int d = 0; d < dim; ++d) {
    double left = 2e-9 * mesh.spacing;  // more than round-off
    for (int e = 0; e < dim; ++e) {
      const double n = shape.normal[e];
      left += n * shape.point[e];
      if (e != d) left -= std::min(n * mesh.lower[e], n * mesh.upper[e]);
    }
    if (shape.normal[d] > 0) bounds.upper[d] = std::min(mesh.upper[d], left / shape.normal[d]);
    if (shape.normal[d] < 0) bounds.lower[d] = std::max(mesh.lower[d], left / shape.normal[d]);
  }
  return bounds;
}

Bounds layer_bounds(const Shape& shape, const MeshConfig& mesh, int dim) {
  const LayerBounds bounds = bounds_between(*shape.top, *shape.base, mesh, dim);
  return {bounds.lower, bounds.upper};
}

}  // namespace

double shape_volume(const Shape& shape, const MeshConfig& mesh, int dim) {
  switch (shape.kind) {
    case ShapeKind::box: return box_volume(shape, mesh, dim);
    case ShapeKind::polygon: return area_of(shape.polygon) * (dim == 3 ? shape.width[1] - shape.width[0] : 1);
    case ShapeKind::disc:
    case ShapeKind::cylinder:
    case ShapeKind::cone: return round_volume(shape, mesh, dim);
    case ShapeKind::half_plane: return part_behind(shape, mesh, dim);
    case ShapeKind::stl: return shape.triangles->volume();
    case ShapeKind::layer: return Facets(shape, mesh, dim, mesh.spacing).volume();
    case ShapeKind::parts: return united_volume(shape, mesh, dim);
    default: return 0;
  }
}

Bounds bounds_of(const Shape& shape, const MeshConfig& mesh, int dim) {
  switch (shape.kind) {
    case ShapeKind::box: return box_bounds(shape, dim);
    case ShapeKind::polygon: return prism_bounds(shape, dim);
    case ShapeKind::disc: return ball_bounds(shape, dim);
    case ShapeKind::cylinder:
    case ShapeKind::cone: return revolved_bounds(shape);
    case ShapeKind::half_plane: return behind_bounds(shape, mesh, dim);
    case ShapeKind::stl: return {shape.triangles->bounds().lower, shape.triangles->bounds().upper};
    case ShapeKind::layer: return layer_bounds(shape, mesh, dim);
    case ShapeKind::parts: return united_bounds(shape, mesh, dim);
    default: return {mesh.lower, mesh.upper};
  }
}

double narrowest(const Shape& shape, const MeshConfig& mesh, int dim) {
  double least = std::numeric_limits<double>::infinity();
  for (const Shape& part : shape.parts) least = std::min(least, narrowest(part, mesh, dim));
  if (shape.kind == ShapeKind::half_plane || shape.kind == ShapeKind::parts) return least;
  const Bounds bounds = bounds_of(shape, mesh, dim);
  const bool turned = shape.kind == ShapeKind::box && shape.angle != 0;
  const double slack = 1e-6 * mesh.spacing;
  for (int d = 0; d < dim; ++d) {
    if (bounds.lower[d] <= mesh.lower[d] + slack || bounds.upper[d] >= mesh.upper[d] - slack) continue;
    least = std::min(least, turned ? shape.upper[d] - shape.lower[d] : bounds.upper[d] - bounds.lower[d]);
  }
  return least;
}

bool is_wide_for_sites(const Shape& shape, const MeshConfig& mesh, int dim) {
  if (shape.kind == ShapeKind::disc) return true;
  if (shape.kind == ShapeKind::parts)
    return std::all_of(shape.parts.begin(), shape.parts.end(),
                       [&](const Shape& part) { return is_wide_for_sites(part, mesh, dim); });
  const double least = k_wide_for_sites * mesh.spacing * (1 - 1e-6);
  if (narrowest(shape, mesh, dim) < least) return false;
  if (shape.kind == ShapeKind::stl) return !thinnest_twentieth(*shape.triangles, least);
  const Point2 lower{mesh.lower[0], mesh.lower[dim - 1]}, upper{mesh.upper[0], mesh.upper[dim - 1]};
  return shape.kind != ShapeKind::polygon || !is_thin(shape.polygon, lower, upper, least);
}

Cuts cuts_of(const Shape& shape, const MeshConfig& mesh, int dim) {
  const Bounds bounds = bounds_of(shape, mesh, dim);
  const double slack = 1e-9 * mesh.spacing;
  Cuts cuts{};
  for (int d = 0; d < dim; ++d)
    cuts[d] = {bounds.lower[d]<mesh.lower[d] - slack, bounds.upper[d]> mesh.upper[d] + slack};
  return cuts;
}

Bounds within(Bounds bounds, const MeshConfig& mesh, int dim) {
  for (int d = 0; d < dim; ++d) {
    bounds.lower[d] = std::max(bounds.lower[d], mesh.lower[d]);
    bounds.upper[d] = std::min(bounds.upper[d], mesh.upper[d]);
  }
  return bounds;
}

}  // namespace mpm
