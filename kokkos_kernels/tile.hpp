#pragma once
// The strategy `tile`: a team sums the shares of its patch's particles in scratch memory, then adds the
// window to the nodes. On a device a thread sums a row of nodes in registers; a thread of the host takes
// particle by particle.

#include <cstring>

#include "window.hpp"

namespace mpm {

template <class Source>
struct Tile {
  using T = typename Source::real;
  using Space = typename Source::Space;
  using Point = typename Source::Point;
  static constexpr int Dim = Source::dim, size = Source::size, window = Patch<Dim>::window;
  static constexpr bool device = is_device<Space>;

  /// A particle on its way to the nodes.
  struct Entry {
    Vector<T, Dim> x;  // cells
    Point point;
  };
  // The stage keeps of an entry, each value apart: for each axis the first and last weight and the last
  // derivative, of which the others follow; the point, without its half length; x where the source asks for
  // it.
  static constexpr bool k_offset = requires { Source::takes_offset; };
  static constexpr int k_point = sizeof(Point) / sizeof(T) - 2;
  static constexpr int k_values = 3 * Dim + k_point + (k_offset ? Dim : 0);
  static constexpr int k_bank = 128 / sizeof(T);  // values in a line of scratch memory
  static constexpr int pitch_of(int entries) { return entries + entries / k_bank; }
  static constexpr std::size_t bytes_of(int entries) {
    return scratch_bytes<T>(size * window) + scratch_bytes<T>(k_values * pitch_of(entries)) +
           scratch_bytes<int>(pitch_of(entries)) + scratch_bytes<int>(window);
  }
  /// Entries that the stage has room for: somewhat more than a patch or layer of 2^Dim particles a cell
  /// holds.
  static constexpr int room() {
    int entries = Dim == 2 ? 288 : 128;
    while (!scratch_fits<Space, T, Dim>(bytes_of(entries))) entries -= 32;
    return entries;
  }
  static constexpr int capacity = device ? room() : 0, pitch = pitch_of(capacity);
  static_assert(!device || capacity >= 32, "a team of this size has no room for the particles");

  int* number;  // of the nodes of the window [window]
  T* sums;      // device [size][window], host [window][size]
  T* stage;     // [k_values][pitch]
  int* firsts;  // [pitch], bit d: AxisWeights::first along d is 0, not -1

  static constexpr std::size_t bytes() { return bytes_of(capacity); }

  KOKKOS_INLINE_FUNCTION explicit Tile(Scratch& scratch)
      : number(scratch.take<int>(window)),
        sums(scratch.take<T>(size * window)),
        stage(scratch.take<T>(k_values * pitch)),
        firsts(scratch.take<int>(pitch)) {}

  KOKKOS_INLINE_FUNCTION T& sum(int node, int value) const {
    return sums[device ? value * window + node : node * size + value];
  }

  template <class Team>
  KOKKOS_INLINE_FUNCTION void clear(const Team& team) const {
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window * size), [&](int n) { sums[n] = 0; });
  }

  /// Gives the particles of the patch to the window. load(p) makes the entry of particle p; it is called once
  /// for each. begin: first particle of a cell of the patch.
  template <class Team, class Begin, class Load>
  KOKKOS_INLINE_FUNCTION void add(const Team& team, const Begin& begin, const Load& load) const {
    if constexpr (device) {
      // In 3D layer by layer of cells: a particle then reaches four layers of nodes, each with its own
      // threads.
      constexpr int layers = Dim == 3 ? Patch<Dim>::edge : 1, cells = Patch<Dim>::cells / layers;
      for (int layer = 0; layer < layers; ++layer) {
        const int end = begin((layer + 1) * cells);
        for (int first = begin(layer * cells); first < end; first += capacity) {
          const int last = Kokkos::min(first + capacity, end);
          Kokkos::parallel_for(Kokkos::TeamThreadRange(team, first, last),
                               [&](int p) { put(p - first, load(p)); });
          team.team_barrier();
          add_rows(team, begin, layer, first, last);
        }
      }
    } else {
      for (int c = 0; c < Patch<Dim>::cells; ++c)
        for (int p = begin(c); p < begin(c + 1); ++p) add_particle(coord_of<Dim>(c), load(p));
    }
  }

  /// Adds the window to the nodes of these numbers; on a device other teams do so too.
  template <class Team, class Field>
  KOKKOS_INLINE_FUNCTION void give_window(const Team& team, const Field& out) const {
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window * size), [&](int m) {
      const int n = m / size, k = m % size;  // neighbours in memory by neighbouring threads
      const T own = sum(n, k);
      if (own == 0) return;
      if constexpr (device)
        Kokkos::atomic_add(&out(number[n], k), own);
      else
        out(number[n], k) += own;
    });
  }

 private:
  KOKKOS_INLINE_FUNCTION static int place(int n) { return n + n / k_bank; }
  KOKKOS_INLINE_FUNCTION void put(int n, const Entry& entry) const {
    T* value = stage + place(n);
    int late = 0;
    for (int d = 0; d < Dim; ++d, value += 3 * pitch) {
      const AxisWeights<T> a = axis_weights_near(entry.x[d], entry.point.half_length);
      value[0] = a.w[0], value[pitch] = a.w[2], value[2 * pitch] = a.g[2];
      late |= (a.first + 1) << d;
    }
    T point[k_point + 2];
    memcpy(point, &entry.point, sizeof point);
    for (int k = 0; k < k_point; ++k, value += pitch) *value = point[k + 2];
    for (int d = 0; d < Dim && k_offset; ++d, value += pitch) *value = entry.x[d];
    firsts[place(n)] = late;
  }
  /// The weights of an entry of the stage along d.
  KOKKOS_INLINE_FUNCTION AxisWeights<T> axis(int n, int d) const {
    const T* const value = stage + place(n) + 3 * d * pitch;
    const T w_0 = value[0], w_2 = value[pitch], g_2 = value[2 * pitch];
    return {0, {w_0, 1 - w_0 - w_2, w_2}, {g_2 - 1, 1 - 2 * g_2, g_2}};
  }
  KOKKOS_INLINE_FUNCTION Point point(int n) const {
    T value[k_point + 2] = {};
    for (int k = 0; k < k_point; ++k) value[k + 2] = stage[place(n) + (3 * Dim + k) * pitch];
    Point q;
    memcpy(&q, value, sizeof q);
    return q;
  }

  /// A thread sums a row of nodes over the particles of a column of cells, those [first, last) on the stage:
  /// four nodes along the first axis, which they reach from the same cell there. Then the threads of a row
  /// add their first nodes, their second ones, and so on: no two the same at once, always in this order.
  template <class Team, class Begin>
  KOKKOS_INLINE_FUNCTION void add_rows(const Team& team, const Begin& begin, int layer, int first,
                                       int last) const {
    constexpr int edge = Patch<Dim>::edge, across = Patch<Dim>::window_edge;
    constexpr int items = edge * across * (Dim == 3 ? 4 : 1);
    for (int start = 0; start < items; start += team.team_size()) {
      const int item = start + team.team_rank(), column = item % edge, row = item / edge % across,
                above = item / (edge * across);
      T own[4][size] = {};
      for (int b = 0; b < 4 && item < items; ++b) {
        const int cell = (layer * edge + row - b) * edge + column;
        if (row - b < 0 || row - b >= edge) continue;
        const int end = Kokkos::min(begin(cell + 1), last) - first;
        for (int n = Kokkos::max(begin(cell), first) - first; n < end; ++n) add_entry(n, b, above, own);
      }
      for (int a = 0; a < 4; ++a) {
        if (item < items) {
          const int node = ((Dim == 3 ? layer + above : 0) * across + row) * across + column + a;
          for (int k = 0; k < size; ++k) sum(node, k) += own[a][k];
        }
        team.team_barrier();
      }
    }
  }

  /// Adds entry n of the stage to four nodes in a row, that of number b along the second axis and `above`
  /// along the third one of those that its cell reaches, counted from 0.
  KOKKOS_INLINE_FUNCTION void add_entry(int n, int b, int above, T (&own)[4][size]) const {
    const int late = firsts[place(n)];
    const int at[3] = {0, b, above};
    T w = 1, grad[Dim] = {};  // of the row: weight, and weight with one factor derived
    for (int d = 1; d < Dim; ++d) {
      const int k = at[d] - (late >> d & 1);
      if (k < 0 || k > 2) return;
      const AxisWeights<T> a = axis(n, d);
      const T s = k == 0 ? a.w[0] : (k == 1 ? a.w[1] : a.w[2]),
              ds = k == 0 ? a.g[0] : (k == 1 ? a.g[1] : a.g[2]);
      for (int e = 1; e < d; ++e) grad[e] *= s;
      grad[d] = ds * w;
      w *= s;
    }
    if (late & 1)
      add_along<1>(n, at, w, grad, own);
    else
      add_along<0>(n, at, w, grad, own);
  }

  /// The three nodes of add_entry that the particle reaches, from number `Late` on.
  template <int Late>
  KOKKOS_INLINE_FUNCTION void add_along(int n, const int (&at)[3], T w, const T (&grad)[Dim],
                                        T (&own)[4][size]) const {
    const AxisWeights<T> along = axis(n, 0);
    const Point q = point(n);
    for (int k = 0; k < 3; ++k) {
      Vector<T, Dim> g;
      g[0] = along.g[k] * w;
      for (int d = 1; d < Dim; ++d) g[d] = along.w[k] * grad[d];
      const auto offset = [&] {
        Vector<T, Dim> r;
        for (int d = 0; d < Dim; ++d)
          r[d] = (d == 0 ? k + Late : at[d]) - 1 - stage[place(n) + (3 * Dim + k_point + d) * pitch];
        return r;
      };
      give<Source>(q, along.w[k] * w, g, offset, [&](int value, T v) { own[k + Late][value] += v; });
    }
  }

  KOKKOS_INLINE_FUNCTION void add_particle(const Coord<Dim>& cell, const Entry& entry) const {
    with_weights_near(entry.x, entry.point.half_length, [&](const AxisWeights<T>(&a)[Dim]) {
      for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const Vector<T, Dim>& grad) {
        const int node = window_place(cell, a, k);
        const auto offset = [&] { return offset_to(entry.x, a, k); };
        give<Source>(entry.point, w, grad, offset, [&](int value, T v) { sum(node, value) += v; });
      });
    });
  }
};

}  // namespace mpm
