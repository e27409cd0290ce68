#pragma once
// Triangles in square bins as seen from above, so that those above and below a point are found without
// a test of all.

#include <array>
#include <vector>

#include "input/geometry/box_tree.hpp"

namespace mpm {

/// A bin holds the triangles that it meets, not those whose boxes it meets: a long thin triangle that lies
/// across the axes has a large box, and is in few bins.
class PlanBins {
 public:
  PlanBins() = default;
  /// `bounds`: of all vertices [m].
  PlanBins(const std::vector<Vec3>& vertices, const std::vector<std::array<int, 3>>& triangles,
           const Box& bounds);

  /// Calls visit(k) for all triangles that may be above or below a point, and some others.
  template <class Visit>
  void visit_at(double x, double y, Visit&& visit) const {
    const double at[2] = {(x - lower_[0]) * per_length_[0], (y - lower_[1]) * per_length_[1]};
    for (int d = 0; d < 2; ++d)
      if (!(at[d] >= -1 && at[d] <= count_ + 1)) return;
    const long bin = bin_of(at[1]) * count_ + bin_of(at[0]);
    for (std::size_t n = first_[bin]; n < first_[bin + 1]; ++n) visit(triangles_[n]);
  }

 private:
  long bin_of(double place) const {
    const long bin = static_cast<long>(place);
    return bin < 0 ? 0 : bin < count_ ? bin : count_ - 1;
  }
  template <class Visit>
  void visit_bins(const std::array<Vec3, 3>& triangle, Visit&& visit) const;

  long count_ = 0;                             // along each axis
  double lower_[2] = {}, per_length_[2] = {};  // m, bins a metre
  std::vector<std::size_t> first_;             // of each bin, row by row, in triangles_
  std::vector<int> triangles_;
};

}  // namespace mpm
