#include "input/geometry/polygon.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/edge_tree.hpp"

namespace mpm {
namespace {

/// Twice the area of the triangle a b c, positive anticlockwise.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
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

/// Whether the boxes round two edges are further apart than `slack` [m]. Edges on one line are not
/// distinguished by their turns, which are round-off there.
bool boxes_apart(const Edge& a, const Edge& b, double slack) {
  for (int d = 0; d < 2; ++d) {
    const auto [a_low, a_high] = std::minmax({a.from[d], a.to[d]});
    const auto [b_low, b_high] = std::minmax({b.from[d], b.to[d]});
    if (a_low - b_high > slack || b_low - a_high > slack) return true;
  }
  return false;
}

/// Whether b is clearly on one side of the line through a: the quick answer for nearly all.
bool beside(const Edge& a, const Edge& b) {
  const auto span = [](const Point2& p, const Point2& q) {
    return std::abs(q[0] - p[0]) + std::abs(q[1] - p[1]);
  };
  const double of_a = span(a.from, a.to), far = span(a.from, b.from) + span(a.from, b.to);
  const double margin = of_a * (2e-12 * (of_a + span(b.from, b.to)) + 1e-15 * far);  // with round-off
  const double first = turn(a.from, a.to, b.from), last = turn(a.from, a.to, b.to);
  return (first > margin && last > margin) || (first < -margin && last < -margin);
}

/// Whether two edges share a point, with a slack of 1e-12 of their lengths.
bool touch(const Edge& a, const Edge& b) {
  if (beside(a, b) || beside(b, a)) return false;
  const double slack = 1e-12 * (length_of(a) + length_of(b));
  if (boxes_apart(a, b, slack)) return false;
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

Edge edge_of(const Polygon& polygon, std::size_t k) {
  return {polygon[k], polygon[(k + 1) % polygon.size()]};
}

double signed_area_of(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) twice += turn(polygon[0], polygon[k], polygon[k + 1]);
  return twice / 2;
}

double area_of(const Polygon& polygon) { return std::abs(signed_area_of(polygon)); }

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

bool cross(const Polygon& polygon, int i, int j) {
  const Edge a = edge_of(polygon, i), b = edge_of(polygon, j);
  if (j == i + 1) return folds_back(a, b);
  const bool previous = i == 0 && j == static_cast<int>(polygon.size()) - 1;
  return previous ? folds_back(b, a) : touch(a, b);
}

std::optional<std::pair<int, int>> first_crossing(const Polygon& polygon) {
  const int count = static_cast<int>(polygon.size());
  for (int i = 0; i < count; ++i)
    if (length_of(edge_of(polygon, i)) == 0) return std::pair(i, (i + 1) % count);
  const EdgeTree tree(polygon);
  for (int i = 0; i < count; ++i) {
    const int j = tree.first_near(i, [&](int k) { return cross(polygon, i, k); });
    if (j < count) return std::pair(i, j);
  }
  return std::nullopt;
}

}  // namespace mpm
