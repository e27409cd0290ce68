#pragma once
// How far the soil of a body reaches round a node, along a normal and across it.

#include "base/types.hpp"

namespace mpm {

/// How soil lies round a node: the centre of its volume there [cells from the node], and the covariance of
/// its places [cells2].
template <class T, int Dim>
struct SoilCloud {
  Vector<T, Dim> centre;
  T spread[Dim][Dim];

  /// A measure of how far the soil reaches along n, of length 1 [cells]: five standard deviations beyond its
  /// centre. A box reaches 1.73 of them; five tell better which body is long along a false normal.
  KOKKOS_INLINE_FUNCTION T reach(const Vector<T, Dim>& n) const {
    constexpr T k_deviations = T(5);
    T square = 0;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) square += n[i] * spread[i][j] * n[j];
    return dot(centre, n) + k_deviations * Kokkos::sqrt(Kokkos::fmax(T(0), square));
  }
  /// How much of the node's cells the soil fills across n, of length 1: 1 where it goes through them, less
  /// where it ends. By the deviations across n, of which a hat function has the square root of a sixth of a
  /// cell each; so neither how dense the soil is counts, nor gaps between its particles.
  KOKKOS_INLINE_FUNCTION T breadth(const Vector<T, Dim>& n) const {
    T square = across(n);
    for (int d = 1; d < Dim; ++d) square *= 6;
    return Kokkos::fmin(T(1), Kokkos::sqrt(Kokkos::fmax(T(0), square)));
  }

 private:
  /// Product of the variances across n.
  KOKKOS_INLINE_FUNCTION T across(const Vector<T, Dim>& n) const {
    const auto& c = spread;
    if constexpr (Dim == 2) {
      return c[1][1] * n[0] * n[0] + c[0][0] * n[1] * n[1] - 2 * c[0][1] * n[0] * n[1];
    } else {
      T sum = 0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, o = (j + 2) % 3;
          sum += n[i] * n[j] * (c[k][m] * c[l][o] - c[k][o] * c[l][m]);
        }
      return sum;
    }
  }
};

}  // namespace mpm
