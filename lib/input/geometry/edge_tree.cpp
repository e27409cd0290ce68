#include "input/geometry/edge_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mpm {

namespace {

Point2 across(const Edge& edge) { return {edge.from[1] - edge.to[1], edge.to[0] - edge.from[0]}; }

/// The directions across those in which the most of the outline runs, each as one of `bins` equal angles,
/// from the most on.
std::vector<Point2> main_directions(const Polygon& polygon, std::size_t count) {
  constexpr int k_bins = 2048;
  std::vector<Point2> sum(k_bins);
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    Point2 normal = across(edge_of(polygon, k));
    if (normal[1] < 0 || (normal[1] == 0 && normal[0] < 0)) normal = {-normal[0], -normal[1]};
    const double part = std::atan2(normal[1], normal[0]) / std::numbers::pi;  // 0 to 1
    Point2& bin = sum[std::clamp(static_cast<int>(part * k_bins), 0, k_bins - 1)];
    bin = {bin[0] + normal[0], bin[1] + normal[1]};
  }
  const auto length = [](const Point2& x) { return std::hypot(x[0], x[1]); };
  std::partial_sort(sum.begin(), sum.begin() + count, sum.end(),
                    [&](const Point2& a, const Point2& b) { return length(a) > length(b); });
  sum.resize(count);
  for (Point2& x : sum)
    if (const double of = length(x); of > 0) x = {x[0] / of, x[1] / of};
  return sum;
}

}  // namespace

EdgeTree::EdgeTree(const Polygon& polygon) : count_(static_cast<int>(polygon.size())) {
  constexpr double k_slack = 4e-12;  // of an edge's length: some more than cross() has
  constexpr double k_far = std::numeric_limits<double>::max();
  while (leaves_ < count_) leaves_ *= 2;
  const double diagonal = std::sqrt(0.5);
  std::vector<Point2> directions{{1, 0}, {diagonal, diagonal}, {0, 1}, {-diagonal, diagonal}};
  for (const Point2& direction : main_directions(polygon, k_directions - k_fixed))
    directions.push_back(direction);
  Reach none;
  none.fill({k_far, -k_far});
  reach_.assign(2 * leaves_, none);
  for (int k = 0; k < count_; ++k) {
    const Edge edge = edge_of(polygon, k);
    const double slack = k_slack * std::hypot(edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]);
    for (int n = 0; n < k_directions; ++n) {
      const auto along = [&](const Point2& x) { return directions[n][0] * x[0] + directions[n][1] * x[1]; };
      // what adding the two products may round off
      const double rounding = n == 0 || n == k_up ? 0
                                                  : 1e-15 * (std::abs(edge.from[0]) + std::abs(edge.from[1]) +
                                                             std::abs(edge.to[0]) + std::abs(edge.to[1]));
      const auto [low, high] = std::minmax({along(edge.from), along(edge.to)});
      reach_[leaves_ + k][n] = {low - slack - rounding, high + slack + rounding};
    }
  }
  for (int node = leaves_ - 1; node > 0; --node)
    for (int n = 0; n < k_directions; ++n)
      reach_[node][n] = {std::min(reach_[2 * node][n].low, reach_[2 * node + 1][n].low),
                         std::max(reach_[2 * node][n].high, reach_[2 * node + 1][n].high)};
}

bool EdgeTree::apart(const Reach& a, const Reach& b) {
  for (int n = 0; n < k_directions; ++n)
    if (a[n].low > b[n].high || b[n].low > a[n].high) return true;
  return false;
}

}  // namespace mpm
