#pragma once
// Boxes in a balanced tree, so that those that meet a box are found without looking at all.

#include <algorithm>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// An axis-aligned box; empty as it is made.
struct Box {
  Vec3 lower{k_none, k_none, k_none}, upper{-k_none, -k_none, -k_none};  // m

  static constexpr double k_none = 1e300;
  void add(const Vec3& x);
  void add(const Box& other);
  /// Square of the distance to a point outside [m2].
  double square_to(const Vec3& x) const {
    double square = 0;
    for (int d = 0; d < 3; ++d) {
      const double off = std::max({lower[d] - x[d], x[d] - upper[d], 0.0});
      square += off * off;
    }
    return square;
  }
  bool meets(const Box& other) const {
    return lower[0] <= other.upper[0] && other.lower[0] <= upper[0] && lower[1] <= other.upper[1] &&
           other.lower[1] <= upper[1] && lower[2] <= other.upper[2] && other.lower[2] <= upper[2];
  }
};

/// A tree that halves the boxes at the median of their centres, along the direction in which these extend
/// furthest: built in n log n.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box> boxes);

  const std::vector<Box>& boxes() const { return boxes_; }
  /// Calls visit(k) for boxes that meet `box`, until it returns true; returns whether it did.
  template <class Visit>
  bool any_near(const Box& box, Visit&& visit) const {
    return !nodes_.empty() && any_in(0, box, visit);
  }

  /// Calls visit(k) for all boxes that are nearer to a point than `least` [m2], which visit may make less;
  /// near ones first.
  template <class Visit>
  void visit_nearest(const Vec3& x, double& least, Visit&& visit) const {
    if (!nodes_.empty() && nodes_[0].box.square_to(x) < least) visit_near(0, x, least, visit);
  }

 private:
  static constexpr int k_leaf = 4;  // boxes
  struct Node {
    Box box;
    int first, last;  // of order_
    int right;        // the second half, behind the first one, which is the next node; 0: a leaf
  };

  void build(int first, int last);
  template <class Visit>
  bool any_in(int n, const Box& box, Visit& visit) const {
    const Node& node = nodes_[n];
    if (!node.box.meets(box)) return false;
    if (node.right > 0) return any_in(n + 1, box, visit) || any_in(node.right, box, visit);
    for (int k = node.first; k < node.last; ++k)
      if (boxes_[order_[k]].meets(box) && visit(order_[k])) return true;
    return false;
  }

  template <class Visit>
  void visit_near(int n, const Vec3& x, double& least, Visit& visit) const {
    const Node& node = nodes_[n];
    if (node.right == 0) {
      for (int k = node.first; k < node.last; ++k)
        if (boxes_[order_[k]].square_to(x) < least) visit(order_[k]);
      return;
    }
    const double left = nodes_[n + 1].box.square_to(x), right = nodes_[node.right].box.square_to(x);
    const bool left_first = left <= right;
    if (left_first && left < least) visit_near(n + 1, x, least, visit);
    if (right < least) visit_near(node.right, x, least, visit);
    if (!left_first && left < least) visit_near(n + 1, x, least, visit);
  }

  std::vector<Box> boxes_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace mpm
