#pragma once
// uGIMP shape functions about the nearest node: the weights of shape_gimp.hpp for a particle that reaches one
// node and those next to it.

#include "base/half_length.hpp"
#include "base/types.hpp"

namespace mpm {

/// Weights along one axis of a node and the two next to it. The weight of the node itself is 1 - below -
/// above.
template <class T>
struct NearestWeights {
  T below, above;  // [-] weights of the nodes before and behind
  T share;         // [-] t, the derivatives of the three weights are t - 1, 1 - 2 t and t [1/cell]

  /// Weight, and derivative [1/cell], of the node before (k = 0), of the node itself, and of that behind.
  KOKKOS_INLINE_FUNCTION T weight(int k) const { return k == 0 ? below : k == 1 ? 1 - below - above : above; }
  KOKKOS_INLINE_FUNCTION T slope(int k) const { return slope_of(share, k); }
  KOKKOS_INLINE_FUNCTION static T slope_of(T share, int k) {
    return k == 0 ? share - 1 : k == 1 ? 1 - 2 * share : share;
  }
};

/// r [cells] particle minus node, |r| <= 1 - l;  half [cells] the particle's half length l. t is the share of
/// the domain that lies behind the node, as far as the domain reaches over the node.
template <class T>
KOKKOS_INLINE_FUNCTION NearestWeights<T> nearest_weights(T r, HalfLengthOf<T> half) {
  const T l = half.l, share = Kokkos::fmin(T(1), Kokkos::fmax(T(0), r * half.inverse + T(0.5))),
          rest = 1 - share;
  return {l * rest * rest + Kokkos::fmax(T(0), -r - l), l * share * share + Kokkos::fmax(T(0), r - l), share};
}

}  // namespace mpm
