#include "input/geometry/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace mpm {

void Box::add(const Vec3& x) {
  for (int d = 0; d < 3; ++d) lower[d] = std::min(lower[d], x[d]), upper[d] = std::max(upper[d], x[d]);
}

void Box::add(const Box& other) {
  add(other.lower);
  add(other.upper);
}

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(boxes_.size());
  if (!boxes_.empty()) build(0, static_cast<int>(boxes_.size()));
}

void BoxTree::build(int first, int last) {
  const int n = static_cast<int>(nodes_.size());
  nodes_.push_back({{}, first, last, 0});
  Box centres;  // twice
  const auto centre = [&](int k, int d) { return boxes_[k].lower[d] + boxes_[k].upper[d]; };
  for (int k = first; k < last; ++k) {
    const int box = order_[k];
    nodes_[n].box.add(boxes_[box]);
    centres.add(Vec3{centre(box, 0), centre(box, 1), centre(box, 2)});
  }
  if (last - first <= k_leaf) return;
  int along = 0;
  for (int d = 1; d < 3; ++d)
    if (centres.upper[d] - centres.lower[d] > centres.upper[along] - centres.lower[along]) along = d;
  const int middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](int a, int b) { return centre(a, along) < centre(b, along); });
  build(first, middle);
  nodes_[n].right = static_cast<int>(nodes_.size());
  build(middle, last);
}

}  // namespace mpm
