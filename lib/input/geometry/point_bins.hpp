#pragma once
// Points in bins, to find those near a place.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

class PointBins {
 public:
  /// width [m]: of the bins; what is looked for is not further than that along any axis.
  PointBins(int dim, double width) : dim_(dim), width_(width) {}
  int size() const { return static_cast<int>(points_.size()); }
  const Vec3& operator[](int n) const { return points_[n]; }
  void add(const Vec3& x) {
    bins_.emplace_back(key_of(bin_of(x)), size());
    points_.push_back(x);
  }
  /// Once, after all are added.
  void order() { std::sort(bins_.begin(), bins_.end()); }
  /// Calls f(number) for the points in the bins round a place, until it returns true; whether it did.
  template <class F>
  bool any_near(const Vec3& x, F&& f) const {
    const Bin centre = bin_of(x);
    const int bins = dim_ == 2 ? 9 : 27;
    for (int k = 0; k < bins; ++k) {
      const std::uint64_t key = key_of(
          {centre[0] + k % 3 - 1, centre[1] + k / 3 % 3 - 1, dim_ == 3 ? centre[2] + k / 9 - 1 : centre[2]});
      for (auto at = std::lower_bound(bins_.begin(), bins_.end(), std::pair{key, 0});
           at != bins_.end() && at->first == key; ++at)
        if (f(at->second)) return true;
    }
    return false;
  }

 private:
  using Bin = std::array<std::int64_t, 3>;
  Bin bin_of(const Vec3& x) const {
    Bin bin{};
    for (int d = 0; d < dim_; ++d) bin[d] = static_cast<std::int64_t>(std::floor(x[d] / width_));
    return bin;
  }
  /// Bins far from each other may have one key: what is near is for the caller to check.
  static std::uint64_t key_of(const Bin& bin) {
    constexpr int k_bits = 21;
    constexpr std::uint64_t k_mask = (std::uint64_t(1) << k_bits) - 1;
    return (std::uint64_t(bin[0]) & k_mask) | (std::uint64_t(bin[1]) & k_mask) << k_bits |
           (std::uint64_t(bin[2]) & k_mask) << (2 * k_bits);
  }

  int dim_;
  double width_;
  std::vector<Vec3> points_;
  std::vector<std::pair<std::uint64_t, int>> bins_;
};

}  // namespace mpm
