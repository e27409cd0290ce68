#pragma once
// The motion of the nodes of a window, and what a particle takes from it.

#include "loops/window.hpp"
#include "physics/advance.hpp"

namespace mpm {

/// The motion of the nodes of a window, in a team's scratch memory. In 3D rows and layers are longer by what
/// keeps the nodes that a warp reads at once in different banks: 8 bytes a node and bank pair, measured on an
/// H200.
template <class T, int Dim>
class MotionWindow {
  using Node = KinematicValues<T, Dim>;
  static constexpr int across = Patch<Dim>::window_edge;
  static constexpr int k_row_gap = Dim == 3 && sizeof(T) == sizeof(double) ? 16 : 0;  // bytes
  static constexpr int k_layer_gap = Dim == 3 ? (sizeof(T) == sizeof(double) ? 32 : 48) : 0;
  static constexpr int k_node = sizeof(Node), k_row = across * k_node + k_row_gap,
                       k_layer = across * k_row + k_layer_gap;
  static constexpr int k_all = Dim == 3 ? across * k_layer : k_layer;
  static_assert(k_row % alignof(Node) == 0 && k_layer % alignof(Node) == 0);

  char* first_;

 public:
  static constexpr std::size_t bytes() { return scratch_bytes<char>(k_all); }

  KOKKOS_INLINE_FUNCTION explicit MotionWindow(Scratch& scratch) : first_(scratch.take<char>(k_all)) {}

  /// Node n of the window, in its own order.
  KOKKOS_INLINE_FUNCTION void set(int n, const Node& motion) const {
    int place = n * k_node + n / across * k_row_gap;
    if constexpr (Dim == 3) place += n / (across * across) * k_layer_gap;
    *reinterpret_cast<Node*>(first_ + place) = motion;
  }
  /// The node k steps from the first one that a particle reaches, from a cell of the patch.
  template <class Weights>
  KOKKOS_INLINE_FUNCTION const Node& at(const Coord<Dim>& cell, const Weights& a,
                                        const Vector<int, Dim>& k) const {
    constexpr int stride[3] = {k_node, k_row, k_layer};
    int place = 0;
    for (int d = 0; d < Dim; ++d) place += (cell[d] + a[d].first + k[d] + 1) * stride[d];
    return *reinterpret_cast<const Node*>(first_ + place);
  }
};

template <ParticleDomain domain, class T, int Dim, class Weights>
KOKKOS_INLINE_FUNCTION GridSample<T, Dim, k_slopes<Dim, domain>> sample_nodes(
    const MotionWindow<T, Dim>& window, const Coord<Dim>& cell, const Weights& a, T inv_spacing) {
  GridSample<T, Dim, k_slopes<Dim, domain>> t{};
  interpolate_by_lines(
      a, [&](const Vector<int, Dim>& k) { return window.at(cell, a, k); }, t.kinematics, t.gradient);
  for (int d = 0; d < Dim; ++d)
    for (int e = 0; e < k_slopes<Dim, domain>; ++e) t.gradient[d][e] *= inv_spacing;
  return t;
}

/// The dilatation rate alone, sum v_i . grad S_ip [1/s], of rings with that of the hoop.
template <ParticleDomain domain, class T, int Dim, class Weights>
KOKKOS_INLINE_FUNCTION T dilatation_from_nodes(const MotionWindow<T, Dim>& window, const Coord<Dim>& cell,
                                               const Weights& a, T inv_spacing) {
  T sum = 0;
  for_each_weight(a, [&](const Vector<int, Dim>& k, T, const auto& grad) {
    const KinematicValues<T, Dim> node = window.at(cell, a, k);
    for (int d = 0; d < Dim; ++d) sum += node[NodeKinematics<Dim>::velocity + d] * grad[d];
    if constexpr (domain == ParticleDomain::ring) sum += node[NodeKinematics<Dim>::velocity] * grad[Dim];
  });
  return sum * inv_spacing;
}

/// The dilatation rate of a sample of the nodes [1/s], of rings with that of the hoop.
template <class T, int Dim, int Slopes>
KOKKOS_INLINE_FUNCTION T dilatation_of(const GridSample<T, Dim, Slopes>& sample) {
  T sum = 0;
  for (int d = 0; d < Dim; ++d) sum += sample.gradient[d][d];
  if constexpr (Slopes > Dim) sum += sample.gradient[0][Dim];
  return sum;
}

}  // namespace mpm
