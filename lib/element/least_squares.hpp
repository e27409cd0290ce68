#pragma once
// Small systems of equations in the sense of least squares.

#include <cmath>
#include <vector>

namespace mpm {

/// Minimises |A x - b|^2 + damping sum_j (|a_j| x_j)^2, where a_j is column j of A: a step of Levenberg and
/// Marquardt. By the modified method of Gram and Schmidt on the rows of A with those of the damping below
/// (Golub & Van Loan 2013, ch. 5.2), which does not square the condition number. A has n rows and columns,
/// row by row. A column of zeros leaves its x at 0.
inline std::vector<double> damped_least_squares(const std::vector<double>& a, const std::vector<double>& b,
                                                double damping) {
  const std::size_t n = b.size(), rows = 2 * n;
  std::vector<double> q(rows * n), r(n * n), right(rows), x(n);
  for (std::size_t i = 0; i < n; ++i) right[i] = b[i];
  for (std::size_t j = 0; j < n; ++j) {
    double square = 0;
    for (std::size_t i = 0; i < n; ++i) q[i * n + j] = a[i * n + j], square += a[i * n + j] * a[i * n + j];
    q[(n + j) * n + j] = std::sqrt(damping * square);
  }
  for (std::size_t j = 0; j < n; ++j) {
    double square = 0, along = 0;
    for (std::size_t i = 0; i < rows; ++i) square += q[i * n + j] * q[i * n + j];
    const double length = std::sqrt(square);
    r[j * n + j] = length;
    if (!(length > 0)) continue;
    for (std::size_t i = 0; i < rows; ++i) q[i * n + j] /= length;
    for (std::size_t k = j + 1; k < n; ++k) {
      double product = 0;
      for (std::size_t i = 0; i < rows; ++i) product += q[i * n + j] * q[i * n + k];
      r[j * n + k] = product;
      for (std::size_t i = 0; i < rows; ++i) q[i * n + k] -= product * q[i * n + j];
    }
    for (std::size_t i = 0; i < rows; ++i) along += q[i * n + j] * right[i];
    for (std::size_t i = 0; i < rows; ++i) right[i] -= along * q[i * n + j];
    x[j] = along;
  }
  for (std::size_t j = n; j-- > 0;) {
    for (std::size_t k = j + 1; k < n; ++k) x[j] -= r[j * n + k] * x[k];
    x[j] = r[j * n + j] > 0 ? x[j] / r[j * n + j] : 0;
  }
  return x;
}

}  // namespace mpm
