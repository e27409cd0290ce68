#pragma once
// Sums at the nodes from particles in bins about nodes. The particles of a patch pass over a stage in scratch
// memory. A warp then takes one of the three layers of nodes that the particles of 32 bins reach, and a lane
// sums the nine nodes of its bin there in registers: first mass and momentum, then force, since all sums at
// once would spill.

#include "device/large_team.hpp"
#include "loops/gpu/node_window.hpp"
#include "physics/p2g_terms.hpp"

namespace mpm {

/// Teams that share a multiprocessor. Fewer of them leave a thread more registers, which laws that are not
/// light need in single precision.
template <class T>
constexpr int teams_about_nodes(bool is_light) {
  return sizeof(T) == sizeof(float) ? (is_light ? 4 : 3) : 2;
}

/// beside: bytes of scratch memory that a team has for something else. at_once: teams that share a
/// multiprocessor.
template <class T, std::size_t beside = 0, int at_once = teams_about_nodes<T>(true)>
struct NodeTile {
  using S = SoilTerms<3>;
  using Window = NodeWindow<T>;
  using Unit = typename Window::Unit;
  static constexpr int edge = Patch<3>::edge, bins = Patch<3>::cells, nodes = Window::nodes;
  static constexpr int layers = 3, warps_of_layer = bins / k_warp, warps = layers * warps_of_layer;
  static constexpr int threads = warps * k_warp;
  static constexpr bool is_single = sizeof(T) == sizeof(float);

  // The stage keeps of a particle the weights below and above along x, y, z, then mass and momentum, - V
  // sigma / d, and the shares t along x, y, z, in units that are read at once and lie apart.
  static constexpr int k_mass = 6, k_stress = 10, k_share = 16, k_values = 20;
  static constexpr int k_unit = Window::k_unit, k_units = k_values / k_unit;
  // Sums of a warp: planes, each of two layers of six rows of nodes. With these lengths of rows and layers no
  // two lanes meet in a bank.
  static constexpr int k_row = is_single ? 8 : 12, k_layer = is_single ? 52 : 72;
  static constexpr int bins_of_layer = edge * edge, bin_layers = k_warp / bins_of_layer;
  static constexpr int k_plane = bin_layers * k_layer;
  static constexpr int k_motion = S::force, k_force = S::size - S::force;  // mass with momentum; force

  static constexpr std::size_t rounded(std::size_t bytes) { return (bytes + 15) / 16 * 16; }
  static constexpr std::size_t sums_bytes(int values) { return sizeof(T) * warps * values * k_plane; }
  static constexpr std::size_t window_bytes() {
    return rounded(Window::bytes() > sums_bytes(k_motion) ? Window::bytes() : sums_bytes(k_motion));
  }
  static constexpr int teams = at_once;
  /// Particles that the stage has room for in what the teams leave each other of the 227 KiB of a
  /// multiprocessor, of which 1 KiB a team is the driver's: at least a tenth more than eight a bin.
  static constexpr int room = [] {
    const std::size_t own =
        227 * 1024 / teams - 1024 - window_bytes() - rounded(sizeof(int) * (bins + 1)) - rounded(beside);
    return static_cast<int>(own / (sizeof(Unit) * k_units) / 8 * 8);
  }();
  static constexpr std::size_t stage_bytes() { return sizeof(Unit) * k_units * room; }
  static constexpr std::size_t bytes() {
    return window_bytes() + stage_bytes() + rounded(sizeof(int) * (bins + 1)) + rounded(beside);
  }
  static_assert(sums_bytes(k_force) + nodes * (S::size * sizeof(T) + sizeof(int)) <= stage_bytes());

  unsigned char* window;  // and, when it is done with, sums of mass and momentum
  Unit* stage;            // and, when it is done with, sums of force, then those of the window
  int* begin;             // first particle of each bin [bins + 1]

  KOKKOS_INLINE_FUNCTION explicit NodeTile(unsigned char* scratch)
      : window(scratch),
        stage(reinterpret_cast<Unit*>(scratch + window_bytes())),
        begin(reinterpret_cast<int*>(scratch + window_bytes() + stage_bytes())) {}

  /// Place on the stage: eight bins of eight particles are in different banks.
  KOKKOS_INLINE_FUNCTION static int place(int n) { return n ^ (n >> 3 & 7); }

  /// Puts a particle on the stage as number n.
  template <class Point>
  KOKKOS_INLINE_FUNCTION void put(int n, const NearestWeights<T> (&a)[3], const Point& q) const {
    T value[k_values];
    for (int d = 0; d < 3; ++d) {
      value[2 * d] = a[d].below, value[2 * d + 1] = a[d].above;
      value[k_mass + 1 + d] = q.momentum[d], value[k_share + d] = a[d].share;
    }
    value[k_mass] = q.mass, value[k_values - 1] = 0;
    for (int k = 0; k < 6; ++k) value[k_stress + k] = q.stress_volume[k];
    for (int u = 0; u < k_units; ++u) {
      Unit unit;
      for (int k = 0; k < k_unit; ++k) unit.c[k] = value[u * k_unit + k];
      stage[u * room + place(n)] = unit;
    }
  }

  /// Particles [first, last) of the stage that are in a lane's bin, which the lane sums.
  struct Range {
    int first, last;
  };

  /// Reads the units that hold the values [from, to) of particle n.
  template <int from, int to>
  KOKKOS_INLINE_FUNCTION void fetch(int n, T (&value)[k_values]) const {
    for (int u = from / k_unit; u < (to + k_unit - 1) / k_unit; ++u) {
      const Unit unit = stage[u * room + place(n)];
      for (int k = 0; k < k_unit; ++k) value[u * k_unit + k] = unit.c[k];
    }
  }
  KOKKOS_INLINE_FUNCTION static NearestWeights<T> axis(const T (&value)[k_values], int d) {
    return {value[2 * d], value[2 * d + 1], value[k_share + d]};
  }
  /// Reads the weights along z, and, unless no lane's particle reaches the layer, the others; whether one
  /// does.
  template <int layer>
  KOKKOS_INLINE_FUNCTION bool reaches(int n, T (&value)[k_values]) const {
    fetch<4, 6>(n, value);
    if (layer != 1 && value[layer == 0 ? 4 : 5] == 0) return false;
    fetch<0, 4>(n, value);
    return true;
  }

  /// Mass and momentum of the nodes of a layer.
  template <int layer>
  KOKKOS_INLINE_FUNCTION void sum_motion(const Range& of, T (&sum)[3][3][k_motion]) const {
    for (int n = of.first; n < of.last; ++n) {
      T value[k_values];
      if (!reaches<layer>(n, value)) continue;
      fetch<(6 / k_unit + is_single) * k_unit, k_stress>(n, value);
      const NearestWeights<T> x = axis(value, 0), y = axis(value, 1), z = axis(value, 2);
      T of_layer[k_motion];
      for (int v = 0; v < k_motion; ++v) of_layer[v] = z.weight(layer) * value[k_mass + v];
      for (int j = 0; j < 3; ++j) {
        const T w = y.weight(j);
        if (j != 1 && w == 0) continue;
        for (int v = 0; v < k_motion; ++v) {
          const T of_row = of_layer[v] * w;
          for (int i = 0; i < 3; ++i) sum[j][i][v] += x.weight(i) * of_row;
        }
      }
    }
  }
  /// Internal force at the nodes of a layer.
  template <int layer>
  KOKKOS_INLINE_FUNCTION void sum_force(const Range& of, T (&sum)[3][3][k_force]) const {
    for (int n = of.first; n < of.last; ++n) {
      T value[k_values];
      if (!reaches<layer>(n, value)) continue;
      fetch<k_stress, k_values>(n, value);
      const NearestWeights<T> x = axis(value, 0), y = axis(value, 1), z = axis(value, 2);
      T part[3][3];  // of - V sigma / d along each axis, with the weight or the slope along z
      for (int d = 0; d < 3; ++d)
        for (int v = 0; v < 3; ++v)
          part[d][v] = value[k_stress + sym_index<3>(v, d)] * (d == 2 ? z.slope(layer) : z.weight(layer));
      for (int j = 0; j < 3; ++j) {
        const T w = y.weight(j), g = y.slope(j);
        if (j != 1 && w == 0) continue;
        for (int v = 0; v < 3; ++v) {
          const T across = part[2][v] * w + part[1][v] * g, along = part[0][v] * w;
          for (int i = 0; i < 3; ++i) {
            sum[j][i][v] += x.weight(i) * across;
            sum[j][i][v] += x.slope(i) * along;
          }
        }
      }
    }
  }

  /// Adds the lanes' sums to those of the warp, which begin at zero: nine rounds, in each of which no two
  /// lanes have the same node.
  template <int values>
  KOKKOS_INLINE_FUNCTION static void add_up(int lane, T* of_warp, const T (&sum)[3][3][values]) {
    constexpr int units = values * k_plane / k_unit;
    for (int n = lane; n < units; n += k_warp) reinterpret_cast<Unit*>(of_warp)[n] = Unit{};
    sync_warp();
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        add_node<values>(lane, of_warp, sum, j, i);
        sync_warp();
      }
  }
  /// Adds a lane's sums of one of its nine nodes.
  template <int values>
  KOKKOS_INLINE_FUNCTION static void add_node(int lane, T* of_warp, const T (&sum)[3][3][values], int j,
                                              int i) {
    T* const at = of_warp + lane / bins_of_layer * k_layer + lane / edge % edge * k_row + lane % edge;
    for (int v = 0; v < values; ++v) at[v * k_plane + j * k_row + i] += sum[j][i][v];
  }

  template <int layer>
  KOKKOS_INLINE_FUNCTION void add_motion(const Range& of, int warp, int lane) const {
    T sum[3][3][k_motion] = {};
    sum_motion<layer>(of, sum);
    add_up(lane, reinterpret_cast<T*>(window) + warp * k_motion * k_plane, sum);
  }

  /// Sums the particles of the bins [first_bin, last_bin), which are on the stage from its begin on. The team
  /// must wait before and after.
  KOKKOS_INLINE_FUNCTION void add(const LargeTeam& team, int first_bin, int last_bin) const {
    const int warp = team.warp(), lane = team.rank % k_warp, layer = warp / warps_of_layer,
              bin = warp % warps_of_layer * k_warp + lane;
    const bool own = bin >= first_bin && bin < last_bin;
    const Range of{own ? begin[bin] - begin[first_bin] : 0, own ? begin[bin + 1] - begin[first_bin] : 0};
    if (layer == 0)
      add_motion<0>(of, warp, lane);
    else if (layer == 1)
      add_motion<1>(of, warp, lane);
    else
      add_motion<2>(of, warp, lane);
    T sum[3][3][k_force] = {};
    if (layer == 0)
      sum_force<0>(of, sum);
    else if (layer == 1)
      sum_force<1>(of, sum);
    else
      sum_force<2>(of, sum);
    team.barrier();  // the stage becomes the sums of force
    add_up(lane, reinterpret_cast<T*>(stage) + warp * k_force * k_plane, sum);
  }

  /// Sums of the window, [nodes][S::size], and the number of each of its nodes less its place in it.
  KOKKOS_INLINE_FUNCTION T* sums() const {
    return reinterpret_cast<T*>(reinterpret_cast<unsigned char*>(stage) + sums_bytes(k_force));
  }
  KOKKOS_INLINE_FUNCTION int* to() const { return reinterpret_cast<int*>(sums() + nodes * S::size); }

  /// Adds the three layers of node n of the window; after add().
  KOKKOS_INLINE_FUNCTION void gather(int n, T (&sum)[S::size]) const {
    const int x = n % Window::edge, y = n / Window::edge % Window::edge,
              z = n / (Window::edge * Window::edge);
    for (int v = 0; v < S::size; ++v) sum[v] = 0;
    for (int k = 0; k < layers; ++k) {
      const int bin_layer = z - k;
      if (bin_layer < 0 || bin_layer >= edge) continue;
      const int warp = k * warps_of_layer + bin_layer / bin_layers,
                at = bin_layer % bin_layers * k_layer + y * k_row + x;
      const T* const motion = reinterpret_cast<const T*>(window) + warp * k_motion * k_plane + at;
      const T* const force = reinterpret_cast<const T*>(stage) + warp * k_force * k_plane + at;
      for (int v = 0; v < k_motion; ++v) sum[v] += motion[v * k_plane];
      for (int v = 0; v < k_force; ++v) sum[S::force + v] += force[v * k_plane];
    }
  }
};

}  // namespace mpm
