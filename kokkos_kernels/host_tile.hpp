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

  static constexpr int k_room = 1024 / sizeof(T);  // particles on the stage, which the cache holds
  /// Particles on their way to the nodes.
  struct alignas(R) Stage {
    T weight[Dim][2][k_room][k_row];  // -, 1/cell: of the nodes -1 to 2 of the cell, and their slopes
    Point point[k_room];
    Vector<T, Dim> x[k_room];  // cells
  };

  Source source;
  decltype(Bins<Space>::begin) begin;
  decltype(Patches<Space, Dim>::around) around;
  NodeField<Space, T, size> out;

  /// Adds the particles of a slot to the nodes.
  void operator()(int slot) const {
    if (source.skips(slot)) return;
    alignas(R) T sums[size][window] = {};
    Stage stage;
    const int to = begin((slot + 1) * cells);
    const bool one_body = of_one_body(source.points, begin(slot * cells), to);
    int c = 0;
    for (int from = begin(slot * cells); from < to; from += k_room) {
      const int end = Kokkos::min(from + k_room, to);
      for (int p = from; p < end; p += W) fill(p, Kokkos::min(W, end - p), one_body, stage, p - from);
      for (;; ++c) {  // a cell may go on in the next lot
        const int first = Kokkos::max(begin(slot * cells + c), from), next = begin(slot * cells + c + 1);
        if (first < Kokkos::min(next, end)) add_cell(c, stage, first - from, Kokkos::min(next, end) - from, sums);
        if (next >= end) break;
      }
    }
    for_each_run<Dim>(around, slot, [&](int place, int node, int count) {
      for (int n = 0; n < count; ++n)
        for (int k = 0; k < size; ++k) out(node + n, k) += sums[k][place + n];
    });
  }

  /// Puts `count` particles from p on to the stage from n on; their weights at once.
  void fill(int p, int count, bool one_body, Stage& stage, int n) const {
    for (int l = 0; l < count; ++l) stage.point[n + l] = source.load(p + l);
    R x[Dim];
    load_field(source.points.coordinate, p, count, x);
    const HalfLength<R> half =
        half_lengths<R>(one_body, count, [&](int l) { return stage.point[n + l].half_length; });
    for (int d = 0; d < Dim; ++d) {
      const AxisWeights<R> a = axis_weights_near(x[d], half);
      put_weights(a.first, a.w, stage.weight[d][0][n]);
      put_weights(a.first, a.g, stage.weight[d][1][n]);
      if (k_offset)
        for (int l = 0; l < count; ++l) stage.x[n + l][d] = x[d][l];
    }
  }

  /// The weights of three nodes from the first one, -1 or 0, as those of four from -1 on.
  static void put_weights(R first, const R (&w)[3], T* to) {
    const auto late = first == 0;
    const R row[k_row] = {select(late, T(0), w[0]), select(late, w[0], w[1]), select(late, w[1], w[2]),
                          select(late, w[2], T(0))};
    store_groups(row, to);
  }

  /// Adds the particles [from, to) of the stage, of one cell of the patch.
  void add_cell(int place, const Stage& stage, int from, int to, T (&sums)[size][window]) const {
    constexpr int layers = Dim == 3 ? k_row : 1;
    const int base = window_base<Dim>(place);
    for (int k = 0; k < layers; ++k) {
      Row own[k_row][size];
      for (int j = 0; j < k_row; ++j)
        for (int n = 0; n < size; ++n) own[j][n] = T(0);
      for (int e = from; e < to; ++e) {
        const Row w_x = Row::load(stage.weight[0][0][e]), g_x = Row::load(stage.weight[0][1][e]);
        unrolled<k_row>([&](auto j) { add_row(stage, e, w_x, g_x, j, k, own[j]); });
      }
      unrolled<k_row>([&](auto j) {
        for (int n = 0; n < size; ++n) {
          T* const row = &sums[n][base + across * (j + across * k)];
          (Row::load(row) + own[j][n]).store(row);
        }
      });
    }
  }

  /// Adds particle e of the stage to the nodes of row j in layer k: its share, with lanes for weights.
  static void add_row(const Stage& stage, int e, Row w_x, Row g_x, int j, int k, Row (&own)[size]) {
    T w = stage.weight[1][0][e][j], g_y = stage.weight[1][1][e][j];
    Vector<Row, Dim> grad;
    if constexpr (Dim == 3) {
      grad[2] = w * stage.weight[2][1][e][k] * w_x;
      w *= stage.weight[2][0][e][k], g_y *= stage.weight[2][0][e][k];
    }
    grad[0] = w * g_x, grad[1] = g_y * w_x;
    const auto offset = [&] {
      Vector<Row, Dim> r;
      constexpr T along[k_row] = {-1, 0, 1, 2};
      r[0] = Row::load(along) - stage.x[e][0];
      r[1] = j - 1 - stage.x[e][1];
      if constexpr (Dim == 3) r[2] = k - 1 - stage.x[e][2];
      return r;
    };
    give<Source>(stage.point[e], Row(w * w_x), grad, offset, [&](int n, Row share) { own[n] += share; });
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
