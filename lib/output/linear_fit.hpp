#pragma once
// A weighted fit of linear functions to values at points around a place (moving least squares), for their
// values at the place itself.

#include <array>
#include <vector>

namespace mpm {

class LinearFit {
 public:
  /// Fits so many functions of `dim` coordinates.
  LinearFit(int dim, int fields) : size_(dim + 1), fields_(fields) {}

  /// A point at r [cells from the place] with the values of the functions there.
  void add(double weight, const double* r, const double* values) {
    double q[4] = {1, 0, 0, 0};
    for (int d = 0; d + 1 < size_; ++d) q[d + 1] = r[d];
    for (int i = 0; i < size_; ++i) {
      for (int j = 0; j < size_; ++j) matrix_[i][j] += weight * q[i] * q[j];
      for (int f = 0; f < fields_; ++f) right_[i][f] += weight * q[i] * values[f];
    }
  }

  /// Values at the place; where the points do not determine a slope, as on one line, their mean. 0 without
  /// points.
  std::vector<double> value() const {
    constexpr double k_spread = 0.01;  // cells2, least variance of the points along an axis
    std::vector<double> mean(static_cast<std::size_t>(fields_)), fitted(mean.size());
    if (!(matrix_[0][0] > 0)) return mean;
    auto a = matrix_;
    auto b = right_;
    for (int f = 0; f < fields_; ++f) mean[f] = b[0][f] / a[0][0];
    for (int k = 0; k < size_; ++k) {  // the matrix is symmetric and positive: no pivots are sought
      if (!(a[k][k] > (k == 0 ? 0 : k_spread * matrix_[0][0]))) return mean;
      for (int i = k + 1; i < size_; ++i) {
        const double factor = a[i][k] / a[k][k];
        for (int j = k; j < size_; ++j) a[i][j] -= factor * a[k][j];
        for (int f = 0; f < fields_; ++f) b[i][f] -= factor * b[k][f];
      }
    }
    for (int f = 0; f < fields_; ++f) {
      double x[4] = {};
      for (int i = size_ - 1; i >= 0; --i) {
        x[i] = b[i][f];
        for (int j = i + 1; j < size_; ++j) x[i] -= a[i][j] * x[j];
        x[i] /= a[i][i];
      }
      fitted[f] = x[0];
    }
    return fitted;
  }

 private:
  static constexpr int k_most_fields = 7;
  int size_, fields_;
  std::array<std::array<double, 4>, 4> matrix_{};
  std::array<std::array<double, k_most_fields>, 4> right_{};
};

}  // namespace mpm
