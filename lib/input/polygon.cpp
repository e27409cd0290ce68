#include "input/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {
namespace {

/// Twice the area of the triangle a b c, positive anticlockwise.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

Edge edge_of(const Polygon& polygon, std::size_t k) {
  return {polygon[k], polygon[(k + 1) % polygon.size()]};
}

double length_of(const Edge& edge) {
  return std::hypot(edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]);
}

double squared(double x) { return x * x; }

/// Square of the distance of a point to an edge.
double distance2(const Edge& edge, const Point2& point) {
  const double dx = edge.to[0] - edge.from[0], dy = edge.to[1] - edge.from[1];
  const double along =
      ((point[0] - edge.from[0]) * dx + (point[1] - edge.from[1]) * dy) / (dx * dx + dy * dy);
  const double t = std::clamp(along, 0.0, 1.0);
  return squared(point[0] - edge.from[0] - t * dx) + squared(point[1] - edge.from[1] - t * dy);
}

/// Whether two edges share a point, with a slack of 1e-12 of their lengths.
bool touch(const Edge& a, const Edge& b) {
  const double slack = 1e-12 * (length_of(a) + length_of(b));
  const auto opposite = [](double u, double v) { return (u > 0 && v < 0) || (u < 0 && v > 0); };
  if (opposite(turn(a.from, a.to, b.from), turn(a.from, a.to, b.to)) &&
      opposite(turn(b.from, b.to, a.from), turn(b.from, b.to, a.to)))
    return true;
  return std::min({distance2(a, b.from), distance2(a, b.to), distance2(b, a.from), distance2(b, a.to)}) <=
         squared(slack);
}

/// Whether the second of two neighbours lies on the first.
bool folds_back(const Edge& first, const Edge& second) {
  const double slack = 1e-12 * (length_of(first) + length_of(second));
  return distance2(first, second.to) <= squared(slack) || distance2(second, first.from) <= squared(slack);
}

}  // namespace

double area_of(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) twice += turn(polygon[0], polygon[k], polygon[k + 1]);
  return std::abs(twice) / 2;
}

std::vector<Edge> edges_in_row(const Polygon& polygon, double low, double high) {
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Edge edge = edge_of(polygon, k);
    const auto [bottom, top] = std::minmax({edge.from[1], edge.to[1]});
    if (top >= low && bottom <= high) edges.push_back(edge);
  }
  return edges;
}

bool is_inside(const std::vector<Edge>& edges, const Point2& point, double slack) {
  bool inside = false;  // a ray towards +x crosses the outline an odd number of times
  for (const Edge& edge : edges) {
    if (distance2(edge, point) <= squared(slack)) return true;
    if ((edge.from[1] > point[1]) == (edge.to[1] > point[1])) continue;
    const double t = (point[1] - edge.from[1]) / (edge.to[1] - edge.from[1]);
    if (point[0] < edge.from[0] + t * (edge.to[0] - edge.from[0])) inside = !inside;
  }
  return inside;
}

bool enters_square(const Edge& edge, const Point2& lower, const Point2& upper, double slack) {
  double enter = 0, leave = 1;  // part of the edge between the four lines (Liang & Barsky 1984)
  for (int d = 0; d < 2; ++d) {
    const double low = lower[d] + slack, high = upper[d] - slack, step = edge.to[d] - edge.from[d];
    if (step == 0) {
      if (edge.from[d] <= low || edge.from[d] >= high) return false;
      continue;
    }
    const auto [first, last] = std::minmax({(low - edge.from[d]) / step, (high - edge.from[d]) / step});
    enter = std::max(enter, first), leave = std::min(leave, last);
  }
  return enter < leave;
}

std::optional<std::pair<int, int>> first_crossing(const Polygon& polygon) {
  const int count = static_cast<int>(polygon.size());
  for (int i = 0; i < count; ++i)
    if (length_of(edge_of(polygon, i)) == 0) return std::pair(i, (i + 1) % count);
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j) {
      const Edge a = edge_of(polygon, i), b = edge_of(polygon, j);
      const bool next = j == i + 1, previous = i == 0 && j == count - 1;
      const bool wrong = next ? folds_back(a, b) : previous ? folds_back(b, a) : touch(a, b);
      if (wrong) return std::pair(i, j);
    }
  return std::nullopt;
}

}  // namespace mpm
