#pragma once
// The strategy `tile` on a processor: a thread sums the terms of the particles of a patch, cell by cell,
// four nodes of a row at once. The sums of a cell stay in registers, those of the patch in the cache.

#include "loops/cpu/host_window.hpp"
#include "loops/particle_to_node.hpp"

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
  static constexpr int k_rows = 32 / sizeof(T) / k_row;  // rows that share a vector
  using Rows = Lanes<T, k_rows * k_row>;
  static constexpr bool k_offset = requires { Source::takes_offset; };
  static constexpr ParticleDomain domain = [] {
    if constexpr (requires { Source::domain; }) return Source::domain;
    return ParticleDomain::fixed;
  }();
  using Domain = DomainOf<R, Dim, domain>;

  static constexpr int k_point = k_point_numbers<T, Point>;
  /// Whether the points of many particles are made at once.
  static constexpr bool k_in_lanes = [] {
    if constexpr (requires { typename Source::template PointOf<T>; })
      return std::is_same_v<Point, typename Source::template PointOf<T>>;
    return false;
  }();
  static constexpr int k_room = 1024 / sizeof(T);  // particles on the stage, which the cache holds
  /// Particles on their way to the nodes.
  static constexpr bool k_rings = domain == ParticleDomain::ring;
  struct alignas(R) Stage {
    T weight[Dim][2][k_room][k_row];      // -, 1/cell: of the nodes -1 to 2 of the cell, and their slopes
    T hoop[k_rings ? k_room : 1][k_row];  // 1/cell: RadialWeights::t
    T value[k_point][k_room + W];         // of the point, each apart, without its half length
    Vector<T, Dim> x[k_room];             // cells
  };

  Source source;
  decltype(Bins<Space>::begin) begin;
  decltype(Patches<Space, Dim>::neighbours) neighbours;
  decltype(Patches<Space, Dim>::origin) origin;
  Grid<T, Dim> grid;
  NodeField<Space, T, size> out;

  using Sums = T (&)[size][window];

  /// Adds the particles of a slot to the nodes.
  void operator()(int slot) const {
    if (source.skips(slot)) return;
    alignas(R) T sums[size][window] = {};
    sum(slot, sums);
    for_each_run<Dim>(neighbours, slot,
                      [&](int place, int node, auto count) { give_run<count>(sums, place, node); });
  }

  /// Adds the particles of a slot to the sums of its window, which are zero; no node beyond a wall keeps any.
  void sum(int slot, Sums sums) const {
    Stage stage;
    const int to = begin((slot + 1) * cells);
    const bool one_body = of_one_body(source.points, begin(slot * cells), to);
    int c = 0;
    for (int from = begin(slot * cells); from < to; from += k_room) {
      const int end = Kokkos::min(from + k_room, to);
      BodyProperties<R> body = body_of<R>(source.points, from);
      for (int p = from; p < end; p += W) {
        const int count = Kokkos::min(W, end - p);
        if (!one_body) body = bodies_of<R>(source.points, p, count);
        fill(p, count, body, stage, p - from);
      }
      for (;; ++c) {  // a cell may go on in the next lot
        const int first = Kokkos::max(begin(slot * cells + c), from), next = begin(slot * cells + c + 1);
        if (first < Kokkos::min(next, end))
          add_cell(c, stage, first - from, Kokkos::min(next, end) - from, sums);
        if (next >= end) break;
      }
    }
    const Coord<Dim> at = origin(slot);
    if (reaches_wall(grid, at)) fold_images<Source>(grid, at, [&](int n, int v) -> T& { return sums[v][n]; });
  }

  /// Adds `count` nodes that lie together, from `place` in the window, to those from number `node` on.
  template <int count>
  void give_run(const T (&sums)[size][window], int place, int node) const {
    T given[count * size];
    if constexpr (count >= k_row) {
      Lanes<T, count> values[size];
      for (int k = 0; k < size; ++k) values[k] = Lanes<T, count>::load(&sums[k][place]);
      store_groups(values, given);
    } else {
      for (int n = 0; n < count; ++n)
        for (int k = 0; k < size; ++k) given[n * size + k] = sums[k][place + n];
    }
    T* const to = &out(node, 0);  // values of a node together, then those of the next
    for (int n = 0; n < count * size; ++n) to[n] += given[n];
  }

  /// Puts `count` particles from p on to the stage from n on; their weights at once.
  KOKKOS_INLINE_FUNCTION void fill(int p, int count, const BodyProperties<R>& body, Stage& stage,
                                   int n) const {
    const Domain half_length = domains_of<domain, R, Dim>(source.points, p, count, body);
    put_points(p, count, body.mass, half_length, stage, n);
    Vector<R, Dim> x;
    load_field(source.points.coordinate, p, count, x.c);
    with_weights_near(x, half_length, [&](const auto& a) {
      for (int d = 0; d < Dim; ++d) {
        put_weights(a[d].first, a[d].w, stage.weight[d][0][n]);
        put_weights(a[d].first, a[d].g, stage.weight[d][1][n]);
      }
      if constexpr (k_rings) {
        put_weights(a.r.first, a.r.t, stage.hoop[n]);
        x[0] = a.r.centroid;
      }
    });
    for (int d = 0; d < Dim && k_offset; ++d)
      for (int l = 0; l < count; ++l) stage.x[n + l][d] = x[d][l];
  }

  KOKKOS_INLINE_FUNCTION void put_points(int p, int count, const R& common_mass, const Domain& half_length,
                                         Stage& stage, int n) const {
    if constexpr (k_in_lanes) {
      const auto& soil = source.points;
      Vector<R, Dim> v;
      SymTensor<R, Dim> stress;
      R volume[1], mass[1] = {common_mass};
      load_field(soil.velocity, p, count, v.c);
      load_field(soil.stress, p, count, stress.c);
      load_field(soil.volume, p, count, volume);
      if (soil.has_own_mass) load_field(soil.mass, p, count, mass);
      const auto point = source.point(half_length, mass[0], v, stress, volume[0]);
      const R* const value = numbers_of<R>(point);
      unrolled<k_point>([&](auto k) { value[k].store(stage.value[k] + n); });
    } else {
      for (int l = 0; l < count; ++l) {
        const Point point = source.load(p + l);
        const T* const value = numbers_of<T>(point);
        for (int k = 0; k < k_point; ++k) stage.value[k][n + l] = value[k];
      }
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION static Point point(const Stage& stage, int e) {
    Point q{};  // its half length has been used
    T* const value = numbers_of<T>(q);
    unrolled<k_point>([&](auto k) { value[k] = stage.value[k][e]; });
    return q;
  }

  /// The weights of three nodes from the first one, -1 or 0, as those of four from -1 on.
  KOKKOS_INLINE_FUNCTION static void put_weights(R first, const R (&w)[3], T* to) {
    const auto late = first == 0;
    const R row[k_row] = {select(late, T(0), w[0]), select(late, w[0], w[1]), select(late, w[1], w[2]),
                          select(late, w[2], T(0))};
    store_groups(row, to);
  }

  /// Adds the particles [from, to) of the stage, of one cell of the patch.
  KOKKOS_INLINE_FUNCTION void add_cell(int place, const Stage& stage, int from, int to, Sums sums) const {
    constexpr int layers = Dim == 3 ? k_row : 1;
    const int base = window_base<Dim>(place);
    for (int k = 0; k < layers; ++k) {
      Rows own[k_row / k_rows][size];
      for (int j = 0; j < k_row / k_rows; ++j)
        for (int n = 0; n < size; ++n) own[j][n] = T(0);
      for (int e = from; e < to; ++e) add_particle(stage, e, k, own);
      unrolled<k_row>([&](auto j) {
        for (int n = 0; n < size; ++n) {
          T* const row = &sums[n][base + across * (j + across * k)];
          (Row::load(row) + part_of<k_row, j % k_rows * k_row>(own[j / k_rows][n])).store(row);
        }
      });
    }
  }

  /// Adds particle e of the stage to the nodes of layer k: its terms, with lanes for the weights.
  KOKKOS_FORCEINLINE_FUNCTION void add_particle(const Stage& stage, int e, int k,
                                                Rows (&own)[k_row / k_rows][size]) const {
    const Rows w_x = repeated<Rows::k_count>(Row::load(stage.weight[0][0][e])),
               g_x = repeated<Rows::k_count>(Row::load(stage.weight[0][1][e]));
    [[maybe_unused]] Rows t_x;
    if constexpr (k_rings) t_x = repeated<Rows::k_count>(Row::load(stage.hoop[e]));
    const Point q = point(stage, e);
    unrolled<k_row / k_rows>([&](auto part) {
      constexpr int j = part * k_rows;
      Rows w = along_y<j>(stage.weight[1][0][e]), g_y = along_y<j>(stage.weight[1][1][e]);
      Vector<Rows, k_slopes_of<Source>> grad;
      if constexpr (k_rings) grad[2] = w * t_x;
      if constexpr (Dim == 3) {
        grad[2] = w * stage.weight[2][1][e][k] * w_x;
        w *= stage.weight[2][0][e][k], g_y *= stage.weight[2][0][e][k];
      }
      grad[0] = w * g_x, grad[1] = g_y * w_x;
      give<Source>(
          q, w * w_x, grad, [&] { return offset(stage.x[e], j, k); },
          [&](int n, Rows term) { own[part][n] += term; });
    });
  }

  /// A weight along y for all nodes of the rows from j on.
  template <int j>
  KOKKOS_FORCEINLINE_FUNCTION static Rows along_y(const T (&weight)[k_row]) {
    if constexpr (k_rows == 1)
      return weight[j];
    else
      return stretched<Rows::k_count, j>(Row::load(weight));
  }

  /// From a particle at x to the nodes of the rows from j on in layer k [cells].
  KOKKOS_INLINE_FUNCTION static Vector<Rows, Dim> offset(const Vector<T, Dim>& x, int j, int k) {
    Vector<Rows, Dim> r;
    for (int l = 0; l < Rows::k_count; ++l) {
      r[0].set(l, l % k_row - 1 - x[0]);
      r[1].set(l, j + l / k_row - 1 - x[1]);
      if constexpr (Dim == 3) r[2].set(l, k - 1 - x[2]);
    }
    return r;
  }
};

}  // namespace mpm
