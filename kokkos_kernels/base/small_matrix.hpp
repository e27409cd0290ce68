#pragma once
// Cofactors, determinant and inverse of matrices of 2 x 2 and 3 x 3 numbers.

#include <Kokkos_Core.hpp>

namespace mpm {

KOKKOS_INLINE_FUNCTION void cofactors(const double (&m)[2][2], double (&c)[2][2]) {
  c[0][0] = m[1][1], c[0][1] = -m[1][0];
  c[1][0] = -m[0][1], c[1][1] = m[0][0];
}
KOKKOS_INLINE_FUNCTION void cofactors(const double (&m)[3][3], double (&c)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    }
}

template <int Dim>
KOKKOS_INLINE_FUNCTION double determinant(const double (&m)[Dim][Dim]) {
  double c[Dim][Dim], sum = 0;
  cofactors(m, c);
  for (int j = 0; j < Dim; ++j) sum += m[0][j] * c[0][j];
  return sum;
}

/// The inverse, by the cofactors. Returns the determinant; where it is 0 the inverse is not finite.
template <int Dim>
KOKKOS_INLINE_FUNCTION double invert(const double (&m)[Dim][Dim], double (&inverse)[Dim][Dim]) {
  double c[Dim][Dim], det = 0;
  cofactors(m, c);
  for (int j = 0; j < Dim; ++j) det += m[0][j] * c[0][j];
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) inverse[i][j] = c[j][i] / det;
  return det;
}

}  // namespace mpm
