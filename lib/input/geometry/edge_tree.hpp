#pragma once
// The edges of a polygon in a tree, so that those near an edge or in a row are found without a test of all.

#include <array>

#include "input/geometry/polygon.hpp"

namespace mpm {

/// A balanced tree over the edges in their order. Each part of it holds how far its edges reach in several
/// directions, some of them across where most of the outline runs, so that the teeth of a comb that lies
/// askew are distinguished too.
class EdgeTree {
 public:
  explicit EdgeTree(const Polygon& polygon);

  /// The least k > i for which edge k lies near edge i and `test(k)` holds; the number of edges if there is
  /// none. Edges that share a point, with the slack of cross(), are near each other.
  template <class Test>
  int first_near(int i, Test&& test) const {
    return i + 1 < count_ ? first_in(1, 0, leaves_, i, reach_[leaves_ + i], test) : count_;
  }

  /// Calls visit(k) for the edges that reach into low <= y <= high [m], in their order.
  template <class Visit>
  void in_row(double low, double high, Visit&& visit) const {
    row_in(1, 0, leaves_, low, high, visit);
  }

 private:
  static constexpr int k_fixed = 4, k_directions = 8;
  struct Interval {
    double low, high;  // m
  };
  using Reach = std::array<Interval, k_directions>;  // along each direction; the first is x, number k_up is y
  static constexpr int k_up = k_fixed / 2;

  static bool apart(const Reach& a, const Reach& b);

  /// Searches the part `node`, whose edges are first to first + width.
  template <class Test>
  int first_in(int node, int first, int width, int i, const Reach& reach, Test& test) const {
    if (first >= count_ || first + width <= i + 1 || apart(reach_[node], reach)) return count_;
    if (width == 1) return test(first) ? first : count_;
    const int half = width / 2, found = first_in(2 * node, first, half, i, reach, test);
    return found < count_ ? found : first_in(2 * node + 1, first + half, half, i, reach, test);
  }
  template <class Visit>
  void row_in(int node, int first, int width, double low, double high, Visit& visit) const {
    if (first >= count_ || reach_[node][k_up].high < low || reach_[node][k_up].low > high) return;
    if (width == 1) return visit(first);
    row_in(2 * node, first, width / 2, low, high, visit);
    row_in(2 * node + 1, first + width / 2, width / 2, low, high, visit);
  }

  int count_ = 0, leaves_ = 1;  // edges; leaves of the tree, a power of 2
  std::vector<Reach> reach_;    // of part k, whose halves are 2 k and 2 k + 1; 1 is the whole
};

}  // namespace mpm
