#pragma once
// Boxes in a balanced tree, so that those that meet a box are found without looking at all.

#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// An axis-aligned box; empty as it is made.
struct Box {
  Vec3 lower{k_none, k_none, k_none}, upper{-k_none, -k_none, -k_none};  // m

  static constexpr double k_none = 1e300;
  void add(const Vec3& x);
  void add(const Box& other);
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

  std::vector<Box> boxes_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace mpm
