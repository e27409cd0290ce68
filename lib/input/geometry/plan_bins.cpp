#include "input/geometry/plan_bins.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {
namespace {

constexpr double k_most_entries = 32;  // a triangle, on average: fewer bins else
constexpr double k_slack = 1e-9;       // bins: more than round-off

/// Range along x of the part of a triangle whose y is from low to high; empty (low above high) where there is
/// none.
std::array<double, 2> range_between(const std::array<std::array<double, 2>, 3>& t, double low, double high) {
  std::array<double, 2> range{Box::k_none, -Box::k_none};
  const auto add = [&range](double x) { range = {std::min(range[0], x), std::max(range[1], x)}; };
  for (int c = 0; c < 3; ++c) {
    const auto &a = t[c], &b = t[(c + 1) % 3];
    if (a[1] >= low && a[1] <= high) add(a[0]);
    for (const double y : {low, high})
      if ((a[1] < y) != (b[1] < y)) add(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
  }
  return range;
}

}  // namespace

template <class Visit>
void PlanBins::visit_bins(const std::array<Vec3, 3>& triangle, Visit&& visit) const {
  std::array<std::array<double, 2>, 3> t;  // in bins
  for (int c = 0; c < 3; ++c)
    for (int d = 0; d < 2; ++d) t[c][d] = (triangle[c][d] - lower_[d]) * per_length_[d];
  const auto [least, most] = std::minmax({t[0][1], t[1][1], t[2][1]});
  const double slack = k_slack * static_cast<double>(count_);
  for (long row = bin_of(least - slack); row <= bin_of(most + slack); ++row) {
    const auto range =
        range_between(t, static_cast<double>(row) - slack, static_cast<double>(row + 1) + slack);
    if (range[0] > range[1]) continue;
    for (long column = bin_of(range[0] - slack); column <= bin_of(range[1] + slack); ++column)
      visit(row * count_ + column);
  }
}

PlanBins::PlanBins(const std::vector<Vec3>& vertices, const std::vector<std::array<int, 3>>& triangles,
                   const Box& bounds) {
  const auto corners = [&](std::size_t k) {
    return std::array<Vec3, 3>{vertices[triangles[k][0]], vertices[triangles[k][1]],
                               vertices[triangles[k][2]]};
  };
  const double most = k_most_entries * static_cast<double>(triangles.size());
  for (count_ = std::max(1L, std::lround(std::sqrt(static_cast<double>(triangles.size()))));;
       count_ = (count_ + 1) / 2) {
    for (int d = 0; d < 2; ++d) {
      const double extent = triangles.empty() ? 0 : bounds.upper[d] - bounds.lower[d];
      lower_[d] = triangles.empty() ? 0 : bounds.lower[d];
      per_length_[d] = extent > 0 ? static_cast<double>(count_) / extent : 0;
    }
    first_.assign(count_ * count_ + 2, 0);
    double entries = 0;
    for (std::size_t k = 0; k < triangles.size() && entries <= most; ++k)
      visit_bins(corners(k), [&](long bin) { ++first_[bin + 2], ++entries; });
    if (entries <= most || count_ == 1) break;
  }
  for (std::size_t bin = 2; bin < first_.size(); ++bin) first_[bin] += first_[bin - 1];
  triangles_.resize(first_.back());
  for (std::size_t k = 0; k < triangles.size(); ++k)
    visit_bins(corners(k), [&](long bin) { triangles_[first_[bin + 1]++] = static_cast<int>(k); });
}

}  // namespace mpm
