#pragma once
// uGIMP shape functions (Bardenhagen & Kober 2004), in units of the cell's edge.

#include <type_traits>

#include "base/half_length.hpp"
#include "base/types.hpp"

namespace mpm {

/// Weight along an axis below which round-off may decide whether a particle reaches a node [-]: particles on
/// a lattice are just at the end of their reach of many nodes.
inline constexpr double k_reached = 1e-6;

/// Weights of the three nodes that a particle reaches along one axis.
///   x [cells] particle's coordinate, in the frame of some cell;  half [cells] its half length
///   first     lowest node reached, in the same frame
///   w[k] [-] weight of node first + k, all >= 0, sum 1;  g[k] [1/cell] its derivative by x, sum 0
/// The weight of the third node is exactly zero where the particle does not reach it.
template <class T>
using FirstNode = std::conditional_t<std::is_arithmetic_v<T>, int, T>;  // a whole number by lane, for lanes
template <class T>
struct AxisWeights {
  FirstNode<T> first;
  T w[3], g[3];
};

/// `first` is known here;  r [cells] the distance from that node, l <= r < 1 + l.
template <class T>
KOKKOS_INLINE_FUNCTION AxisWeights<T> weights_from(FirstNode<T> first, T r, HalfLengthOf<T> half) {
  AxisWeights<T> a;
  const T l = half.l;
  a.first = first;
  const T over = Kokkos::fmax(T(0), r - 1 + l);  // how far the particle reaches beyond the second node
  a.g[2] = over * half.inverse;
  a.g[0] = a.g[2] - 1;
  a.g[1] = 1 - 2 * a.g[2];
  a.w[2] = l * a.g[2] * a.g[2];
  a.w[0] = Kokkos::fmax(T(0), 1 - l - r) +
           l * a.g[0] * a.g[0];  // no cancellation: positive wherever g[0] is not 0
  a.w[1] = 1 - a.w[0] - a.w[2];
  return a;
}

/// Weights of a particle at any x.
template <class T>
KOKKOS_INLINE_FUNCTION AxisWeights<T> axis_weights(T x, HalfLengthOf<T> half) {
  const T low = Kokkos::floor(x - half.l);
  return weights_from<T>(static_cast<int>(low), x - low, half);
}

/// Weights of a particle that has drifted from its cell, [0, 1), by half a cell at most: nodes -1 to 2 hold
/// all that it reaches, and `first` is -1 or 0. A third node that it does not reach makes room for that.
template <class T>
KOKKOS_INLINE_FUNCTION AxisWeights<T> axis_weights_near(T x, HalfLengthOf<T> half) {
  const T low = x - half.l;
  const auto beyond = low >= 1;
  const auto first = select(low < 0, FirstNode<T>(-1), FirstNode<T>(0));
  AxisWeights<T> a = weights_from<T>(first, x - first - select(beyond, T(1), T(0)), half);
  for (int k = 2; k >= 0; --k) {
    a.w[k] = select(beyond, k > 0 ? a.w[k - 1] : T(0), a.w[k]);
    a.g[k] = select(beyond, k > 0 ? a.g[k - 1] : T(0), a.g[k]);
  }
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

/// Interpolates N nodal values to a particle, and the gradients [1/cell] of the first M of them; the sums
/// over the nodes go line by line along the first axis. at(k) gives the values of the node k steps from the
/// first.
template <int N, int M, class T, int Dim, class At, class V>
KOKKOS_INLINE_FUNCTION void interpolate_by_lines(const AxisWeights<T> (&a)[Dim], At&& at, V (&value)[N],
                                                 V (&gradient)[M][Dim]) {
  const int layers = Dim == 3 ? 3 : 1;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < 3; ++j) {
      V along[N] = {}, slope[M] = {};
      for (int i = 0; i < 3; ++i) {
        Vector<int, Dim> step{i, j};
        if constexpr (Dim == 3) step[2] = k;
        const auto& node = at(step);
        for (int n = 0; n < N; ++n) along[n] += a[0].w[i] * node[n];
        for (int n = 0; n < M; ++n) slope[n] += a[0].g[i] * node[n];
      }
      const T w_k = Dim == 3 ? a[Dim - 1].w[k] : T(1), w = a[1].w[j] * w_k;
      for (int n = 0; n < N; ++n) value[n] += w * along[n];
      for (int n = 0; n < M; ++n) {
        gradient[n][0] += w * slope[n];
        gradient[n][1] += a[1].g[j] * w_k * along[n];
        if constexpr (Dim == 3) gradient[n][2] += a[1].w[j] * a[2].g[k] * along[n];
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

/// The weights of a particle along every axis. x [cells], domain [cells] its half length, or half lengths.
template <class T, int Dim, class Domain, class F>
KOKKOS_INLINE_FUNCTION void with_weights(const Vector<T, Dim>& x, const Domain& domain, F&& f) {
  AxisWeights<T> a[Dim];
  for (int d = 0; d < Dim; ++d) a[d] = axis_weights(x[d], domain[d]);
  f(a);
}

/// Weight S [-] of one node along one axis and its derivative dS [1/cell].
///   r [cells] particle minus node;  half [cells] half length
template <class T>
KOKKOS_INLINE_FUNCTION void node_weight(T r, HalfLengthOf<T> half, T& s, T& ds) {
  const T l = half.l, a = Kokkos::fabs(r), near = Kokkos::fmax(T(0), l - a);
  const T u =  // share of the particle this side of 1
      Kokkos::fmin(T(1), Kokkos::fmax(T(0), (1 + l - a) * half.inverse));
  s = Kokkos::fmax(T(0), 1 - l - a) + l * u * u - near * near * half.inverse;
  const T slope = 2 * near * half.inverse - u;
  ds = r < 0 ? -slope : slope;
}

/// Weight [-] of one node and its gradient [1/cell].
///   x [cells] particle minus node;  domain [cells] half length, or half lengths
template <class T, int Dim, class Domain>
KOKKOS_INLINE_FUNCTION T single_node_weight(const Vector<T, Dim>& x, const Domain& domain,
                                            Vector<T, Dim>& grad) {
  T s[Dim], ds[Dim], w = 1;
  for (int d = 0; d < Dim; ++d) {
    node_weight(x[d], domain[d], s[d], ds[d]);
    w *= s[d];
  }
  for (int d = 0; d < Dim; ++d) {
    grad[d] = ds[d];
    for (int e = 0; e < Dim; ++e) grad[d] *= e == d ? T(1) : s[e];
  }
  return w;
}
/// From the particle to that node [cells], as offset_to.
template <class T, int Dim, class Domain>
KOKKOS_INLINE_FUNCTION Vector<T, Dim> offset_from(const Vector<T, Dim>& x, const Domain&) {
  Vector<T, Dim> r;
  for (int d = 0; d < Dim; ++d) r[d] = -x[d];
  return r;
}

}  // namespace mpm
