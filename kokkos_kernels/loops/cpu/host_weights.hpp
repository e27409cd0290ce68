#pragma once
// What particles take from the nodes of a window on a processor: the weights of many particles at once, then
// the values of a node at once for each of them.

#include "loops/cpu/host_window.hpp"

namespace mpm {

/// Weights of as many particles as an instruction takes.
template <class T, int Dim, ParticleDomain domain>
struct HostWeights {
  static constexpr int W = native_lanes<T>;
  static constexpr bool rings = domain == ParticleDomain::ring;
  using R = Lanes<T, W>;
  using OfOne = std::conditional_t<rings, RingWeights<T>, AxisWeights<T>[Dim]>;

  alignas(R) T weight[Dim][2][3][W], shift[W], hoop[rings ? 3 : 1][W];

  /// x: coordinates [cells]; half: of the particles' domains.
  template <class Half>
  [[gnu::always_inline]] void find(const Vector<R, Dim>& x, const Half& half) {
    R to_first = 0;
    with_weights_near(x, half, [&](const auto& a) {
      // Unrolled: a loop counter as the index would copy the weights through memory once more.
      unrolled<Dim>([&](auto d) MPM_INLINE_LAMBDA {
        unrolled<3>([&](auto k) MPM_INLINE_LAMBDA {
          a[d].w[k].store(weight[d][0][k]), a[d].g[k].store(weight[d][1][k]);
        });
        to_first += T(power(Patch<Dim>::window_edge, d)) * (a[d].first + 1);
      });
      if constexpr (rings)
        for (int k = 0; k < 3; ++k) a.r.t[k].store(hoop[k]);
    });
    to_first.store(shift);
  }
  /// Sets `a` to the weights of the particle in a lane.
  [[gnu::always_inline]] void take(int lane, OfOne& a) const {
    const auto set = [&](AxisWeights<T>& axis, int d) {
      for (int k = 0; k < 3; ++k) axis.w[k] = weight[d][0][k][lane], axis.g[k] = weight[d][1][k][lane];
    };
    if constexpr (rings) {
      set(a.r, 0), set(a.z, 1);
      for (int k = 0; k < 3; ++k) a.r.t[k] = hoop[k][lane];
    } else {
      for (int d = 0; d < Dim; ++d) set(a[d], d);
    }
  }
  /// Place in the window of the lowest node that the particle in a lane reaches, less window_base().
  int first(int lane) const { return static_cast<int>(shift[lane]); }
};

/// Values and slopes [1/cell] at a particle with the weights `a`, of all values of a node at once. first: the
/// lowest node that it reaches, in a window of nodes of as many values as Node has lanes.
template <int Dim, class Node, class T, class Weights, int slopes>
KOKKOS_FORCEINLINE_FUNCTION void sample_window(const T* first, const Weights& a, Node (&value)[1],
                                               Node (&gradient)[1][slopes]) {
  constexpr int across = Patch<Dim>::window_edge;
  value[0] = T(0);
  for (int d = 0; d < slopes; ++d) gradient[0][d] = T(0);
  interpolate_by_lines(
      a,
      [&](const Vector<int, Dim>& k) {
        const int place = k[0] + across * (k[1] + (Dim == 3 ? across * k[Dim - 1] : 0));
        struct {
          Node v;
          KOKKOS_INLINE_FUNCTION const Node& operator[](int) const { return v; }
        } node{Node::load(first + place * Node::k_count)};
        return node;
      },
      value, gradient);
}

}  // namespace mpm
