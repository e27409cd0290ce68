#pragma once
// The strategy `tile` on a device: a team sums the terms of its patch's particles in scratch memory, then
// adds the window to the nodes. The particles pass over a stage, and a thread sums four nodes of a row in
// registers. host_tile.hpp is the loop shape of a processor.

#include <cstring>
#include <type_traits>

#include "device/warp.hpp"
#include "loops/window.hpp"
#include "physics/walls.hpp"

namespace mpm {

/// Lots of a patch that follow each other.
struct Lots {
  int first, count;
};

/// teams: those that share a multiprocessor.
template <class Source, int teams = teams_at_once<typename Source::real, Source::dim>>
class Tile {
 public:
  using T = typename Source::real;
  using Space = typename Source::Space;
  using Point = typename Source::Point;
  static constexpr int Dim = Source::dim, size = Source::size, window = Patch<Dim>::window;

  /// In 3D layer by layer of cells: a particle then reaches four layers of nodes, each with its own threads.
  static constexpr int lots = Dim == 3 ? Patch<Dim>::edge : 1;
  KOKKOS_INLINE_FUNCTION static constexpr Lots all_lots() { return {0, lots}; }

  /// A particle on its way to the nodes.
  struct Entry {
    Vector<T, Dim> x;  // cells
    Point point;
  };

 private:
  static constexpr int edge = Patch<Dim>::edge, across = Patch<Dim>::window_edge, cells = Patch<Dim>::cells;
  static constexpr int k_reach = 4;  // nodes that the particles of a cell reach along an axis
  static constexpr int k_layers = Dim == 3 ? k_reach : 1;
  static constexpr bool k_offset = requires { Source::takes_offset; };
  static constexpr int k_half = k_domain_numbers<T, Point>, k_point = k_point_numbers<T, Point>;
  static constexpr bool k_rings = k_slopes_of<Source> > Dim;
  static constexpr int k_weights = 3 * Dim + (k_rings ? 4 : 0);
  static constexpr int k_values = k_weights + k_point + (k_offset ? Dim : 0);

  // The stage keeps of an entry, in units that are read at once and lie apart: for each axis, the first one
  // last, the weight of the first node and that of the last, with the derivative of the last, of which the
  // others follow; of rings also the derivative of the first and the hoop weights; the point; x where the
  // source asks for it. The sign of the first weight gives the place of the first node: negative for node 0
  // of the cell, positive for node -1.
  static constexpr int k_unit = 16 / sizeof(T), k_units = (k_values + k_unit - 1) / k_unit;
  struct alignas(16) Unit {
    T c[k_unit];
  };
  // A place is left free after eight, so that cells of four and eight particles are in different banks.
  KOKKOS_INLINE_FUNCTION static constexpr int place(int n) { return n + n / 8; }
  static constexpr std::size_t bytes_of(int entries) {
    return scratch_bytes<Unit>(k_units * place(entries)) + scratch_bytes<T>(size * window) +
           scratch_bytes<int>(cells + 1) + scratch_bytes<int>(window);
  }
  /// Entries that the stage has room for: somewhat more than a patch or layer of 2^Dim particles a cell
  /// holds, and all that three rounds of a team take where few teams leave it the memory; less where a
  /// processor does what only tests ask of it.
  static constexpr int room() {
    const bool much = Dim == 2 && sizeof(T) == sizeof(float) && teams <= 3;
    int entries = (Dim == 2 ? (much ? 384 : 288) : 128) / (is_device<Space> ? 1 : 2);
    while (!scratch_fits<Space, T, Dim>(bytes_of(entries), much ? teams : teams_at_once<T, Dim>))
      entries -= 32;
    return entries;
  }
  static constexpr int capacity = room(), pitch = place(capacity);
  static_assert(capacity >= 32, "a team of this size has no room for the particles");

  Unit* stage_;  // [k_units][pitch]
  T* sums_;      // [window][size]
  int* begin_;   // first particle of each cell [cells + 1]
  int* to_;      // number of each node of the window, less its place in it [window]

 public:
  static constexpr std::size_t bytes() { return bytes_of(capacity); }

  KOKKOS_INLINE_FUNCTION explicit Tile(Scratch& scratch)
      : stage_(scratch.take<Unit>(k_units * pitch)),
        sums_(scratch.take<T>(size * window)),
        begin_(scratch.take<int>(cells + 1)),
        to_(scratch.take<int>(window)) {}

  /// Before all else, as clear(), and the team must wait for both: the number of node n of the window, that
  /// of its image where it lies beyond a wall.
  KOKKOS_INLINE_FUNCTION void set_node(int n, int number) const { to_[n] = number - n; }

  /// begin(c): first particle of cell c of the patch.
  template <class Team, class Begin>
  KOKKOS_INLINE_FUNCTION void clear(const Team& team, const Begin& begin) const {
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, cells + 1), [&](int c) { begin_[c] = begin(c); });
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window * size), [&](int n) { sums_[n] = 0; });
  }

  /// Gives the particles of some lots of the patch to the window. load(p) makes the entry of particle p; it
  /// is called once for each.
  template <class Team, class Load>
  KOKKOS_INLINE_FUNCTION void add(const Team& team, const Load& load, const Lots& some = all_lots()) const {
    for (int lot = some.first; lot < some.first + some.count; ++lot) {
      const int end = begin_[(lot + 1) * (cells / lots)];
      for (int first = begin_[lot * (cells / lots)]; first < end; first += capacity) {
        const int last = Kokkos::min(first + capacity, end);
        Kokkos::parallel_for(Kokkos::TeamThreadRange(team, first, last),
                             [&](int p) { put(place(p - first), load(p)); });
        team.team_barrier();
        add_rows(team, lot, first, last);
        team.team_barrier();
      }
    }
  }

  /// Adds the window to the nodes; other teams do so too. images: NoImages, or WindowImages.
  template <class Team, class Field, class Images>
  KOKKOS_INLINE_FUNCTION void give_window(const Team& team, const Field& out, const Images& images) const {
    if constexpr (!std::is_same_v<Images, NoImages>)
      if (images.at_wall) {
        turn_sums<Source>(team, images, sums_);
        team.team_barrier();
      }
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window * size), [&](int m) {
      const T own = sums_[m];  // neighbours in memory by neighbouring threads
      if (own != 0) Kokkos::atomic_add(out.data() + (m + size * static_cast<long>(to_[m / size])), own);
    });
  }

 private:
  KOKKOS_INLINE_FUNCTION void put(int n, const Entry& entry) const {
    T value[k_units * k_unit] = {};
    Vector<T, Dim> x = entry.x;
    with_weights_near(entry.x, entry.point.half_length, [&](const auto& all) {
      for (int d = 0; d < Dim; ++d) {
        const AxisWeights<T>& a = all[d];
        T* const axis = value + 3 * (d == 0 ? Dim - 1 : d - 1);
        axis[0] = a.first == 0 ? -a.w[0] : a.w[0], axis[1] = a.w[2], axis[2] = a.g[2];
      }
      if constexpr (k_rings) {
        value[3 * Dim] = all.r.g[0];
        for (int k = 0; k < 3; ++k) value[3 * Dim + 1 + k] = all.r.t[k];
        x[0] = all.r.centroid;
      }
    });
    T point[k_point + k_half];
    memcpy(point, &entry.point, sizeof point);
    for (int k = 0; k < k_point; ++k) value[k_weights + k] = point[k + k_half];
    for (int d = 0; d < Dim && k_offset; ++d) value[k_weights + k_point + d] = x[d];
    for (int u = 0; u < k_units; ++u) {
      Unit unit;  // written at once
      for (int k = 0; k < k_unit; ++k) unit.c[k] = value[u * k_unit + k];
      stage_[u * pitch + n] = unit;
    }
  }

  /// Weight and derivative of one node along an axis.
  struct Weight {
    T w, g;
  };
  /// Weight of node k of the three that a particle reaches, from an entry's values for the axis.
  KOKKOS_INLINE_FUNCTION static Weight weight(const T* axis, int k) {
    const T w_0 = Kokkos::fabs(axis[0]);
    return k == 0   ? Weight{w_0, axis[2] - 1}
           : k == 1 ? Weight{1 - w_0 - axis[1], 1 - 2 * axis[2]}
           : k == 2 ? Weight{axis[1], axis[2]}
                    : Weight{0, 0};
  }

  /// A thread sums a row of nodes over the particles of a column of cells, those [first, last) on the stage:
  /// four nodes along the first axis, which they reach from the same cell there. Then the threads of a row,
  /// all of one warp, add their first nodes, their second ones, and so on: no two the same at once, always in
  /// this order.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void add_rows(const Team& team, int layer, int first, int last) const {
    constexpr int items = edge * across * k_layers;
    for (int start = 0; start < items; start += team.team_size()) {
      const int item = start + team.team_rank(), column = item % edge, row = item / edge % across,
                above = item / (edge * across);
      T own[k_reach][size] = {};
      unrolled<k_reach>([&](auto b) {
        const int line = row - b;
        if (item >= items || line < 0 || line >= edge) return;
        const int cell = (layer * edge + line) * edge + column;
        const int end = Kokkos::min(begin_[cell + 1], last) - first;
        for (int n = Kokkos::max(begin_[cell], first) - first; n < end; ++n)
          add_entry<b>(stage_ + place(n), above, own);
      });
      T* const to = sums_ + (((Dim == 3 ? layer + above : 0) * across + row) * across + column) * size;
      for (int a = 0; a < k_reach; ++a) {
        if (item < items)
          for (int k = 0; k < size; ++k) to[a * size + k] += own[a][k];
        sync_warp();
      }
    }
  }

  /// Adds an entry of the stage to four nodes in a row, that of number b along the second axis and `above`
  /// along the third one of those that its cell reaches.
  template <int b>
  KOKKOS_INLINE_FUNCTION static void add_entry(const Unit* entry, int above, T (&own)[k_reach][size]) {
    T value[k_units * k_unit];
    const auto fetch = [&](int u) {
      const Unit unit = entry[u * pitch];
      for (int k = 0; k < k_unit; ++k) value[u * k_unit + k] = unit.c[k];
    };
    constexpr int few = (k_weights + k_unit - 1) / k_unit;  // units that hold the weights
    for (int u = 0; u < few; ++u) fetch(u);
    Weight s[Dim];  // along the second axis on
    for (int d = 1; d < Dim; ++d) {
      const T* const axis = value + 3 * (d - 1);
      const int k = d == 1 ? b : above;
      s[d] = std::signbit(axis[0]) ? weight(axis, k - 1) : weight(axis, k);
      if (s[d].w == 0 && s[d].g == 0) return;
    }
    for (int u = few; u < k_units; ++u) fetch(u);
    T w = s[1].w, grad[Dim] = {0, s[1].g};  // of the row: weight, and weight with one factor derived
    if constexpr (Dim == 3) grad[1] *= s[2].w, grad[2] = w * s[2].g, w *= s[2].w;
    if (std::signbit(value[3 * (Dim - 1)]))
      add_along<1>(value, {0, b, above}, w, grad, own);
    else
      add_along<0>(value, {0, b, above}, w, grad, own);
  }

  /// The three nodes of add_entry that the particle reaches, from number `late` on.
  template <int late>
  KOKKOS_INLINE_FUNCTION static void add_along(const T* value, const Vector<int, 3>& at, T w,
                                               const T (&grad)[Dim], T (&own)[k_reach][size]) {
    T values[k_point + k_half] = {};
    for (int k = 0; k < k_point; ++k) values[k + k_half] = value[k_weights + k];
    Point q;
    memcpy(&q, values, sizeof q);
    // Parts of each value that go with the weight along the row, and with its derivative.
    T along[size] = {}, slope[size] = {};
    [[maybe_unused]] T hoop[k_rings ? size : 1] = {};
    unrolled<size>([&](auto v) {
      constexpr int first = first_taken<Source>(v);
      if constexpr (first == k_slopes_of<Source>) along[v] = w * Source::factor(q, v);
      if constexpr (first == 0) slope[v] = w * Source::slope(q, v, 0);
      if constexpr (k_rings && Source::takes(v, Dim)) hoop[v] = w * Source::slope(q, v, Dim);
      unrolled<Dim>([&](auto d) {
        if constexpr (d > 0 && Source::takes(v, d)) along[v] += grad[d] * Source::slope(q, v, d);
      });
    });
    for (int k = 0; k < 3; ++k) {
      Weight s = weight(value + 3 * (Dim - 1), k);
      if constexpr (k_rings)
        s.g = k == 0 ? value[3 * Dim] : k == 2 ? s.g : -(value[3 * Dim] + value[3 * Dim - 1]);
      unrolled<size>([&](auto v) {
        constexpr int first = first_taken<Source>(v);
        if constexpr (first == k_slopes_of<Source> || first_taken<Source>(v, 1) < Dim)
          own[k + late][v] += s.w * along[v];
        if constexpr (first == 0) own[k + late][v] += s.g * slope[v];
        if constexpr (k_rings && Source::takes(v, Dim)) own[k + late][v] += value[3 * Dim + 1 + k] * hoop[v];
      });
      if constexpr (k_offset) {
        Vector<T, Dim> offset;
        for (int d = 0; d < Dim; ++d)
          offset[d] = (d == 0 ? k + late : at[d]) - 1 - value[k_weights + k_point + d];
        Source::give_more(q, s.w * w, offset, [&](int v, T more) { own[k + late][v] += more; });
      }
    }
  }
};

/// A team gives the points of a slot, or of some lots of it, to the nodes. number_of(n): number of the image
/// of node n of the window, by `images`; cell_begin(c): the first point of cell c of the patch.
template <class Source, class Team, class Number, class Begin, class Images, class Field>
KOKKOS_INLINE_FUNCTION void sum_patch(const Team& team, Scratch scratch, const Source& source,
                                      const Number& number_of, const Begin& cell_begin, const Images& images,
                                      const Field& out, const Lots& some = Tile<Source>::all_lots()) {
  using Tile_ = Tile<Source>;
  const Tile_ tile(scratch);
  Kokkos::parallel_for(Kokkos::TeamThreadRange(team, Patch<Source::dim>::window),
                       [&](int n) { tile.set_node(n, number_of(n)); });
  tile.clear(team, cell_begin);
  team.team_barrier();
  tile.add(
      team,
      [&](int p) {
        return typename Tile_::Entry{source.points.coordinate(p), source.load(p)};
      },
      some);
  tile.give_window(team, out, images);
}

}  // namespace mpm
