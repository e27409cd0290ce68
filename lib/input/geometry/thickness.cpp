#include "input/geometry/thickness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

/// Thickness inwards from a point, at most `most` [m].
double thickness_at(const TriangleSurface& surface, const Vec3& x, const Vec3& inward, double most) {
  constexpr int k_steps = 12;
  for (int n = 1; n <= k_steps; ++n) {
    const double way = most * n / k_steps;
    if (!surface.holds(along(x, way, inward), 0)) return way;
  }
  return most;
}

/// Way [m] from a point straight inwards to the next of the edges, which go round anticlockwise, that lies
/// across it to 30 degrees: corners are not thin.
double way_across(const std::vector<Edge>& edges, const Point2& x, const Point2& inward) {
  constexpr double k_facing = 0.866;
  const auto cross = [](const Point2& a, const Point2& b) { return a[0] * b[1] - a[1] * b[0]; };
  double least = std::numeric_limits<double>::infinity();
  for (const Edge& edge : edges) {
    const Point2 along{edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]},
        from{edge.from[0] - x[0], edge.from[1] - x[1]};
    const double across = cross(inward, along), way = cross(from, along) / across,
                 share = cross(from, inward) / across;
    if (across > k_facing * std::hypot(along[0], along[1]) && way > 0 && share >= 0 && share <= 1)
      least = std::min(least, way);
  }
  return least;
}

}  // namespace

std::optional<Thickness> thinnest_twentieth(const TriangleSurface& surface, double most) {
  constexpr int k_points = 2000, k_twentieth = k_points / 20;
  const double share = surface.area() / k_points;
  std::vector<Thickness> found;
  double passed = 0;  // area of triangles before
  for (int k = 0; k < surface.size(); ++k) {
    const Vec3 a = surface.corner(k, 0), u = difference(surface.corner(k, 1), a),
               v = difference(surface.corner(k, 2), a), twice = outer_product(u, v);
    const double area = length_of(twice) / 2;
    for (; passed + area > share * (static_cast<double>(found.size()) + 0.5);) {
      // Places of a triangle by multiples of the golden ratio and of its square (Roberts 2018).
      const double n = static_cast<double>(found.size()), p = std::fmod(0.7548776662 * n, 1),
                   q = std::fmod(0.5698402910 * n, 1);
      const bool beyond = p + q > 1;
      const Vec3 x = along(along(a, beyond ? 1 - p : p, u), beyond ? 1 - q : q, v);
      found.push_back({thickness_at(surface, x, along({}, -1, unit_of(twice)), most), x});
    }
    passed += area;
  }
  if (found.size() <= k_twentieth) return {};
  const auto thinner = [](const Thickness& one, const Thickness& other) { return one.value < other.value; };
  std::nth_element(found.begin(), found.begin() + k_twentieth, found.end(), thinner);
  const Thickness& least = found[k_twentieth];
  return least.value < most ? std::optional(least) : std::nullopt;
}

bool is_thin(const Polygon& polygon, const Point2& lower, const Point2& upper, double most) {
  constexpr int k_points = 400;
  const double slack = 1e-6 * most;
  const auto is_beyond = [&](const Edge& edge) {
    bool beyond = false;
    for (int c = 0; c < 2; ++c)
      beyond = beyond || std::max(edge.from[c], edge.to[c]) <= lower[c] + slack ||
               std::min(edge.from[c], edge.to[c]) >= upper[c] - slack;
    return beyond;
  };
  const auto length_of = [](const Edge& edge) {
    return std::hypot(edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]);
  };
  const bool clockwise = signed_area_of(polygon) < 0;
  std::vector<Edge> edges;
  double around = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    Edge edge = edge_of(polygon, k);
    if (is_beyond(edge)) continue;
    if (clockwise) std::swap(edge.from, edge.to);
    edges.push_back(edge), around += length_of(edge);
  }
  const double share = around / k_points;
  double passed = 0;  // length of the edges before
  int found = 0, thin = 0;
  for (const Edge& edge : edges) {
    const double length = length_of(edge);
    const Point2 unit{(edge.to[0] - edge.from[0]) / length, (edge.to[1] - edge.from[1]) / length};
    for (; passed + length > share * (found + 0.5); ++found) {
      const double at = share * (found + 0.5) - passed;
      const Point2 x{edge.from[0] + at * unit[0], edge.from[1] + at * unit[1]};
      thin += way_across(edges, x, {-unit[1], unit[0]}) < most;
    }
    passed += length;
  }
  return 20 * thin > found;
}

}  // namespace mpm
