#pragma once
// The strategy `tile` on a processor: a thread sums the shares of the particles of a patch, cell by cell, four
// nodes of a row at once. The sums of a cell stay in registers, those of the patch in the cache.

#include "host_window.hpp"
#include "particle_to_node.hpp"

namespace mpm {

template <class Source>
struct HostTile {
  using T = typename Source::real;
  using Space = typename Source::Space;
  using Point = typename Source::Point;
  static constexpr int Dim = Source::dim, size = Source::size, cells = Patch<Dim>::cells;
  static constexpr int window = Patch<Dim>::window, across = Patch<Dim>::window_edge;
  static constexpr int W = native_lanes<T>, k_row = 4;  // nodes that particles of a cell reach along an axis
  using R = Lanes<T, W>;
  using Row = Lanes<T, k_row>;
  static constexpr bool k_offset = requires { Source::takes_offset; };

  /// A particle on its way to the nodes.
  struct Entry {
    alignas(Row) T weight[Dim][2][k_row];  // -, 1/cell: of the nodes -1 to 2 of its cell, and their slopes
    Point point;
    Vector<T, Dim> x;  // cells
  };

  Source source;
  decltype(Bins<Space>::begin) begin;
  decltype(Patches<Space, Dim>::around) around;
  NodeField<Space, T, size> out;

  /// Adds the particles of a slot to the nodes.
  void operator()(int slot) const {
    if (source.skips(slot)) return;
    alignas(R) T sums[size][window] = {};
    Entry entries[k_host_stage<T>];
    const int to = begin((slot + 1) * cells);
    int c = 0;
    for (int from = begin(slot * cells); from < to; from += k_host_stage<T>) {
      const int end = Kokkos::min(from + k_host_stage<T>, to);
      for (int p = from; p < end; p += W) fill(p, Kokkos::min(W, end - p), entries + (p - from));
      for (;; ++c) {  // a cell may go on in the next lot
        const int first = Kokkos::max(begin(slot * cells + c), from), next = begin(slot * cells + c + 1);
        if (first < Kokkos::min(next, end))
          add_cell(c, entries + (first - from), Kokkos::min(next, end) - first, sums);
        if (next >= end) break;
      }
    }
    for_each_run<Dim>(around, slot, [&](int place, int node, int count) {
      for (int n = 0; n < count; ++n)
        for (int k = 0; k < size; ++k) out(node + n, k) += sums[k][place + n];
    });
  }

  /// Makes the entries of `count` particles from p on; their weights at once.
  void fill(int p, int count, Entry* entries) const {
    for (int l = 0; l < count; ++l) entries[l].point = source.load(p + l);
    R x[Dim];
    load_field(source.points.coordinate, p, count, x);
    const HalfLength<R> half = half_lengths<R>(count, [&](int l) { return entries[l].point.half_length; });
    for (int d = 0; d < Dim; ++d) {
      const AxisWeights<R> a = axis_weights_near(x[d], half);
      const auto late = a.first == 0;
      alignas(R) T weights[2][W * k_row];
      R row[k_row];
      for (int slope = 0; slope < 2; ++slope) {
        const R(&w)[3] = slope == 0 ? a.w : a.g;
        row[0] = select(late, T(0), w[0]);
        row[1] = select(late, w[0], w[1]);
        row[2] = select(late, w[1], w[2]);
        row[3] = select(late, w[2], T(0));
        store_groups(row, weights[slope]);
        for (int l = 0; l < count; ++l) Row::load(weights[slope] + l * k_row).store(entries[l].weight[d][slope]);
      }
      if (k_offset)
        for (int l = 0; l < count; ++l) entries[l].x[d] = x[d][l];
    }
  }

  /// Adds `count` particles of a cell of the patch.
  void add_cell(int place, const Entry* entries, int count, T (&sums)[size][window]) const {
    constexpr int layers = Dim == 3 ? k_row : 1;
    const int base = window_base<Dim>(place);
    for (int k = 0; k < layers; ++k) {
      Row own[k_row][size];
      for (int j = 0; j < k_row; ++j)
        for (int n = 0; n < size; ++n) own[j][n] = T(0);
      for (int e = 0; e < count; ++e) {
        const Entry& entry = entries[e];
        const Row w_x = Row::load(entry.weight[0][0]), g_x = Row::load(entry.weight[0][1]);
        unrolled<k_row>([&](auto j) { add_row(entry, w_x, g_x, j, k, own[j]); });
      }
      unrolled<k_row>([&](auto j) {
        for (int n = 0; n < size; ++n) {
          T* const row = &sums[n][base + across * (j + across * k)];
          (Row::load(row) + own[j][n]).store(row);
        }
      });
    }
  }

  /// Adds a particle to the nodes of row j in layer k: the same share of the particle, with lanes for weights.
  static void add_row(const Entry& entry, Row w_x, Row g_x, int j, int k, Row (&own)[size]) {
    T w = entry.weight[1][0][j], g_y = entry.weight[1][1][j];
    Vector<Row, Dim> grad;
    if constexpr (Dim == 3) {
      grad[2] = w * entry.weight[2][1][k] * w_x;
      w *= entry.weight[2][0][k], g_y *= entry.weight[2][0][k];
    }
    grad[0] = w * g_x, grad[1] = g_y * w_x;
    const auto offset = [&] {
      Vector<Row, Dim> r;
      constexpr T along[k_row] = {-1, 0, 1, 2};
      r[0] = Row::load(along) - entry.x[0];
      r[1] = j - 1 - entry.x[1];
      if constexpr (Dim == 3) r[2] = k - 1 - entry.x[2];
      return r;
    };
    give<Source>(entry.point, Row(w * w_x), grad, offset, [&](int n, Row share) { own[n] += share; });
  }
};

/// The interpolation on a processor, colour by colour: windows of one colour share no node.
template <class Source>
void sum_on_host(const Interpolation<Source>& it) {
  using Space = typename Source::Space;
  const HostTile<Source> tile{it.source, it.bins.begin, it.patches.around, it.out};
  const auto slots = it.bins.by_colour;
  const auto control = it.control;
  for_each_launch<Space, Source::dim>(it.bins, [&](int first, int last) {
    Kokkos::parallel_for("mpm::reduce_by_tile",
                         Kokkos::RangePolicy<Space, Kokkos::Schedule<Kokkos::Dynamic>>(it.space, first, last,
                                                                                       Kokkos::ChunkSize(1)),
                         [=](int n) {
                           if (!control().paused) tile(slots(n));
                         });
  });
}

}  // namespace mpm
