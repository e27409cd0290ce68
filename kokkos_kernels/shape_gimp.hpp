#pragma once
// uGIMP shape functions (Bardenhagen & Kober 2004), in units of the cell's edge.

#include "types.hpp"

namespace mpm {

/// Weights of the three nodes that a particle reaches along one axis.
///   x [cells] particle's coordinate, in the frame of some cell;  l [cells] half length, 0 < l <= 1/2
///   first     lowest node reached, in the same frame
///   w[k] [-] weight of node first + k, all >= 0, sum 1;  g[k] [1/cell] its derivative by x, sum 0
/// The weight of the third node is exactly zero where the particle does not reach it.
template <class T>
struct AxisWeights {
  int first;
  T w[3], g[3];
};

template <class T>
KOKKOS_INLINE_FUNCTION AxisWeights<T> axis_weights(T x, T l) {
  AxisWeights<T> a;
  const T low = Kokkos::floor(x - l);
  a.first = static_cast<int>(low);
  const T r = x - low;                           // distance from the first node, l <= r < 1 + l
  const T over = Kokkos::fmax(T(0), r - 1 + l);  // how far the particle reaches beyond the second node
  a.g[2] = over * (T(0.5) / l);
  a.g[0] = a.g[2] - 1;
  a.g[1] = 1 - 2 * a.g[2];
  a.w[2] = l * a.g[2] * a.g[2];
  a.w[0] = Kokkos::fmax(T(0), 1 - l - r) +
           l * a.g[0] * a.g[0];  // no cancellation: positive wherever g[0] is not 0
  a.w[1] = 1 - a.w[0] - a.w[2];
  return a;
}

/// Calls f(k, w, grad) for each of the 3^Dim nodes that a particle reaches: k the steps from the first node,
/// w [-] the weight, grad [1/cell] its gradient. The one place where weights of axes are multiplied.
template <class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void for_each_weight(const AxisWeights<T> (&a)[Dim], F&& f) {
  if constexpr (Dim == 2) {
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        f(Vector<int, 2>{i, j}, a[0].w[i] * a[1].w[j],
          Vector<T, 2>{a[0].g[i] * a[1].w[j], a[0].w[i] * a[1].g[j]});
  } else {
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) {
        const T w_jk = a[1].w[j] * a[2].w[k], gy = a[1].g[j] * a[2].w[k], gz = a[1].w[j] * a[2].g[k];
        for (int i = 0; i < 3; ++i)
          f(Vector<int, 3>{i, j, k}, a[0].w[i] * w_jk,
            Vector<T, 3>{a[0].g[i] * w_jk, a[0].w[i] * gy, a[0].w[i] * gz});
      }
  }
}

/// From a particle at x to its node k steps from the first one [cells].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Vector<T, Dim> offset_to(const Vector<T, Dim>& x, const AxisWeights<T> (&a)[Dim],
                                                const Vector<int, Dim>& k) {
  Vector<T, Dim> r;
  for (int d = 0; d < Dim; ++d) r[d] = a[d].first + k[d] - x[d];
  return r;
}

/// The weights of a particle along every axis. x [cells], l [cells] half length.
template <class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void with_weights(const Vector<T, Dim>& x, T l, F&& f) {
  AxisWeights<T> a[Dim];
  for (int d = 0; d < Dim; ++d) a[d] = axis_weights(x[d], l);
  f(a);
}

/// Weight S [-] of one node along one axis and its derivative dS [1/cell].
///   r [cells] particle minus node;  l [cells] half length
template <class T>
KOKKOS_INLINE_FUNCTION void node_weight(T r, T l, T& s, T& ds) {
  const T a = Kokkos::fabs(r), near = Kokkos::fmax(T(0), l - a);
  const T u =
      Kokkos::fmin(T(1), Kokkos::fmax(T(0), (1 + l - a) / (2 * l)));  // share of the particle this side of 1
  s = Kokkos::fmax(T(0), 1 - l - a) + l * u * u - near * near / (2 * l);
  ds = Kokkos::copysign(T(1), r) * (near / l - u);
}

}  // namespace mpm
