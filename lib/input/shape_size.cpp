// Volumes and bounds of shapes.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "input/polygon.hpp"
#include "input/region.hpp"
#include "input/shapes.hpp"

namespace mpm {
namespace {

/// The box made smaller by its fillet, and all within the fillet of it (Steiner's formula).
double box_volume(const Shape& shape, int dim) {
  constexpr double k_pi = std::numbers::pi;
  const double r = shape.fillet;
  Vec3 e{};
  for (int d = 0; d < dim; ++d) e[d] = std::max(0.0, shape.upper[d] - shape.lower[d] - 2 * r);
  if (dim == 2) return e[0] * e[1] + 2 * r * (e[0] + e[1]) + k_pi * r * r;
  return e[0] * e[1] * e[2] + 2 * r * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]) +
         k_pi * r * r * (e[0] + e[1] + e[2]) + 4 * k_pi / 3 * r * r * r;
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

/// Of the corners of the box made smaller by its fillet, turned; the fillet reaches out from them.
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

}  // namespace

double shape_volume(const Shape& shape, const MeshConfig& mesh, int dim) {
  constexpr double k_pi = std::numbers::pi;
  const double r = shape.radius;
  switch (shape.kind) {
    case ShapeKind::box: return box_volume(shape, dim);
    case ShapeKind::polygon: return area_of(shape.polygon) * (dim == 3 ? shape.width[1] - shape.width[0] : 1);
    case ShapeKind::disc: return dim == 2 ? k_pi * r * r : 4 * k_pi / 3 * r * r * r;
    case ShapeKind::half_plane: return part_behind(shape, mesh, dim);
    default: return 0;
  }
}

Bounds bounds_of(const Shape& shape, const MeshConfig& mesh, int dim) {
  switch (shape.kind) {
    case ShapeKind::box: return box_bounds(shape, dim);
    case ShapeKind::polygon: return prism_bounds(shape, dim);
    case ShapeKind::disc: return ball_bounds(shape, dim);
    default: return {mesh.lower, mesh.upper};
  }
}

}  // namespace mpm
