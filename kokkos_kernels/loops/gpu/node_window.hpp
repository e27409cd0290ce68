#pragma once
// The window of a patch whose bins are about nodes: the patch's own nodes and one more on each side, -1 to
// edge. Their motion lies in scratch memory with the differences between neighbours along x beside it: along
// a row a value is then u + w_above D_above - w_below D_below, and its slope D_below + t (D_above - D_below).

#include "data/nodes.hpp"
#include "physics/shape_nearest.hpp"

namespace mpm {

template <class T>
struct NodeWindow {
  static constexpr int edge = Patch<3>::edge + 2, nodes = power(edge, 3);
  static constexpr int values = NodeKinematics<3>::size, k_unit = 16 / sizeof(T);
  static constexpr int step[3] = {1, edge, edge* edge};  // to the next node along an axis
  struct alignas(16) Unit {
    T c[k_unit];
  };
  struct alignas(2 * sizeof(T)) Pair {
    T c[2];
  };
  using Motion = KinematicValues<T, 3>;

  unsigned char* motion;       // planes of units of 16 bytes, then, in single precision, one of pairs
  unsigned char* differences;  // likewise: of node n + 1 less node n

  static constexpr std::size_t plane_bytes() { return nodes * values * sizeof(T); }
  static constexpr std::size_t bytes() { return 2 * plane_bytes(); }
  KOKKOS_INLINE_FUNCTION explicit NodeWindow(unsigned char* scratch)
      : motion(scratch), differences(scratch + plane_bytes()) {}

  /// Coordinates in the patch of node n of the window, and back, of the node with the number of a bin.
  KOKKOS_INLINE_FUNCTION static Coord<3> coord(int n) {
    return {n % edge - 1, n / edge % edge - 1, n / (edge * edge) - 1};
  }
  /// The lowest of the 27 nodes that the particles of a bin reach; the bin's number is its node's in the
  /// patch.
  KOKKOS_INLINE_FUNCTION static int lowest_of(int bin) {
    const Coord<3> c = coord_of<3>(bin);
    return (c[2] * edge + c[1]) * edge + c[0];
  }

  KOKKOS_INLINE_FUNCTION static Motion load(const unsigned char* from, int n) {
    Motion u;
    constexpr int whole = values / k_unit;
    for (int k = 0; k < whole; ++k) {
      const Unit unit = reinterpret_cast<const Unit*>(from)[k * nodes + n];
      for (int i = 0; i < k_unit; ++i) u.c[k * k_unit + i] = unit.c[i];
    }
    if constexpr (values % k_unit != 0) {
      const Pair pair = reinterpret_cast<const Pair*>(from + whole * nodes * sizeof(Unit))[n];
      u.c[whole * k_unit] = pair.c[0], u.c[whole * k_unit + 1] = pair.c[1];
    }
    return u;
  }
  KOKKOS_INLINE_FUNCTION static void store(unsigned char* to, int n, const Motion& u) {
    constexpr int whole = values / k_unit;
    for (int k = 0; k < whole; ++k) {
      Unit unit;
      for (int i = 0; i < k_unit; ++i) unit.c[i] = u.c[k * k_unit + i];
      reinterpret_cast<Unit*>(to)[k * nodes + n] = unit;
    }
    if constexpr (values % k_unit != 0)
      reinterpret_cast<Pair*>(to + whole * nodes * sizeof(Unit))[n] = {u.c[whole * k_unit],
                                                                       u.c[whole * k_unit + 1]};
  }

  /// Sets the differences; the motion of all nodes must be there, and the team must wait.
  KOKKOS_INLINE_FUNCTION void subtract(int n) const {
    const Motion a = load(motion, n);
    Motion b = load(motion, n + 1);
    for (int k = 0; k < values; ++k) b.c[k] -= a.c[k];
    store(differences, n, b);
  }

  /// The dilatation rate times a cell's edge at a particle with the weights a, whose lowest node is number n.
  KOKKOS_INLINE_FUNCTION T dilatation(int n, const NearestWeights<T> (&a)[3]) const {
    T sum = 0;
    for (int k = 0; k < 3; ++k) {
      T along_x = 0, along_y = 0, along_z = 0;
      for (int j = 0; j < 3; ++j) {
        const int row = n + k * step[2] + j * step[1];
        const Motion u = load(motion, row + 1), below = load(differences, row),
                     above = load(differences, row + 1);
        const auto value = [&](int v) { return u.c[v] + a[0].above * above.c[v] - a[0].below * below.c[v]; };
        along_x += a[1].weight(j) * (below.c[0] + a[0].share * (above.c[0] - below.c[0]));
        along_y += a[1].slope(j) * value(1);
        along_z += a[1].weight(j) * value(2);
      }
      sum += a[2].weight(k) * (along_x + along_y) + a[2].slope(k) * along_z;
    }
    return sum;
  }

  /// Motion at a particle with the weights a, whose lowest node is number n, and the velocity's gradient
  /// times a cell's edge.
  KOKKOS_INLINE_FUNCTION void sample(int n, const NearestWeights<T> (&a)[3], T (&value)[values],
                                     T (&gradient)[3][3]) const {
    for (int v = 0; v < values; ++v) value[v] = 0;
    for (int d = 0; d < 9; ++d) gradient[d / 3][d % 3] = 0;
    for (int k = 0; k < 3; ++k) {
      T layer[values] = {}, slope_x[3] = {}, slope_y[3] = {};
      for (int j = 0; j < 3; ++j) {
        const int row = n + k * step[2] + j * step[1];
        const Motion u = load(motion, row + 1), below = load(differences, row),
                     above = load(differences, row + 1);
        const T w = a[1].weight(j), g = a[1].slope(j);
        for (int v = 0; v < values; ++v) {
          const T along = u.c[v] + a[0].above * above.c[v] - a[0].below * below.c[v];
          layer[v] += w * along;
          if (v >= 3) continue;
          slope_x[v] += w * (below.c[v] + a[0].share * (above.c[v] - below.c[v]));
          slope_y[v] += g * along;
        }
      }
      const T w = a[2].weight(k), g = a[2].slope(k);
      for (int v = 0; v < values; ++v) value[v] += w * layer[v];
      for (int v = 0; v < 3; ++v) {
        gradient[v][0] += w * slope_x[v];
        gradient[v][1] += w * slope_y[v];
        gradient[v][2] += g * layer[v];
      }
    }
  }
};

}  // namespace mpm
