#pragma once
// Samples of the nodes for the particles of some cells, on a processor: written particle by particle, read by
// lane.

#include "base/lanes.hpp"
#include "physics/advance.hpp"

namespace mpm {

/// The samples of up to `room` particles, in their order; slopes: as k_slopes.
template <class T, int Dim, int room, int slopes>
struct HostSamples {
  static constexpr int W = native_lanes<T>, k_motion = NodeKinematics<Dim>::size;
  using R = Lanes<T, W>;
  static constexpr int k_node = k_motion <= 4 ? 4 : 8;  // values of a node, with a gap in 3D
  using Node = Lanes<T, k_node>;
  /// Whether the values of a particle lie together, and permutations turn them into lanes. The more values,
  /// the more permutations: in 3D each value is stored where its lane reads it.
  static constexpr bool k_together = Dim == 2 && slopes == Dim;
  static constexpr int k_pitch = room + W;  // not a power of two: values would drive each other out

  using Together = T[k_pitch][4];
  template <int values>
  using Apart = T[values][k_pitch];
  alignas(R) std::conditional_t<k_together, Together, Apart<k_motion>> kinematics;  // m/s, m/s2
  alignas(
      R) std::conditional_t<k_together, Together, Apart<slopes * Dim>> gradient;  // 1/s, L_id at d * Dim + i

  alignas(R) T rate[k_pitch];  // 1/s, of dilatation

  /// Particle n: the values of NodeKinematics, and their gradients along each axis [1/cell]. with_rate: the
  /// rate of dilatation is asked for.
  KOKKOS_FORCEINLINE_FUNCTION void put(int n, const Node& value, const Node (&slope)[slopes], T inv_spacing,
                                       bool with_rate) {
    if constexpr (k_together) {
      value.store(kinematics[n]);
      unrolled<Dim>([&](auto d) { (part_of<Dim, 0>(slope[d]) * inv_spacing).store(gradient[n] + d * Dim); });
    } else {
      for (int k = 0; k < k_motion; ++k) kinematics[k][n] = value[k];
      for (int d = 0; d < slopes; ++d)
        for (int i = 0; i < Dim; ++i) gradient[d * Dim + i][n] = slope[d][i] * inv_spacing;
    }
    if (!with_rate) return;
    T sum = 0;
    for (int d = 0; d < slopes; ++d) sum += slope[d][d < Dim ? d : 0];  // of the hoop v_r / r
    rate[n] = sum * inv_spacing;
  }
  /// The particles from n on, by lane.
  KOKKOS_FORCEINLINE_FUNCTION GridSample<R, Dim, slopes> get(int n) const {
    R motion[k_motion], by_axis[slopes * Dim];
    if constexpr (k_together) {
      load_groups(kinematics[n], motion);
      load_groups(gradient[n], by_axis);
    } else {
      for (int k = 0; k < k_motion; ++k) motion[k] = R::load(kinematics[k] + n);
      for (int k = 0; k < slopes * Dim; ++k) by_axis[k] = R::load(gradient[k] + n);
    }
    GridSample<R, Dim, slopes> t;
    for (int k = 0; k < k_motion; ++k) t.kinematics[k] = motion[k];
    for (int k = 0; k < slopes * Dim; ++k) t.gradient[k % Dim][k / Dim] = by_axis[k];
    return t;
  }
};

}  // namespace mpm
