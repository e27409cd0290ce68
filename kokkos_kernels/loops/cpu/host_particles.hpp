#pragma once
// update_particles on a processor: a thread moves the particles of a patch, as many at once as an instruction
// takes.

#include "data/contact_core.hpp"
#include "loops/cpu/host_laws.hpp"
#include "loops/cpu/host_samples.hpp"
#include "loops/cpu/host_weights.hpp"
#include "physics/advance.hpp"
#include "physics/walls.hpp"

namespace mpm {

/// Moves the particles of patches.
template <class Space, class T, int Dim, ParticleDomain domain>
struct HostParticles {
  static constexpr int W = native_lanes<T>, cells = Patch<Dim>::cells, window = Patch<Dim>::window;
  using R = Lanes<T, W>;
  static constexpr int k_motion = NodeKinematics<Dim>::size, slopes = k_slopes<Dim, domain>;
  static constexpr bool rings = domain == ParticleDomain::ring;
  static constexpr int k_room = 2048 / sizeof(T);  // particles on the stage, which the cache holds
  using Samples = HostSamples<T, Dim, k_room, slopes>;
  static constexpr int k_node = Samples::k_node;
  using Node = typename Samples::Node;
  /// Samples of the nodes for the particles of some cells, in their order.
  struct alignas(R) Stage {
    Samples samples;
    T mean[k_room + W];    // 1/s, dilatation rate of the particle's cell; first the particle's term of it
    int base[k_room + W];  // window_base of its cell
    bool one_body;         // all particles of the patch
    bool at_wall;          // the patch
  };

  Soil<Space, T, Dim> soil;
  decltype(Bins<Space>::begin) begin;
  decltype(Patches<Space, Dim>::neighbours) neighbours;
  decltype(Patches<Space, Dim>::origin) origin;
  decltype(Nodes<Space, T, Dim>::kinematics) kinematics;
  ControlView<Space> control;
  Grid<T, Dim> grid;
  decltype(Strays<Space>::alone) alone;
  decltype(Strays<Space>::put_back) put_back;
  UpdateScalars<T> by;
  double spacing;
  Dilatations<Space, T> dilatation;  // of a crowd that is averaged by material

  /// Asks for what the next slot takes from the nodes.
  void fetch_nodes(int slot) const {
    const int last = last_around<Dim>(neighbours, slot);
    if (last >= 0) fetch(&kinematics(last * cells, 0), cells * k_motion * sizeof(T));
  }
  /// The particles of a slot. Returns the largest component of their movements [cells].
  T operator()(int slot) const {
    alignas(Node) T nodes[window][k_node];
    for_each_run<Dim>(neighbours, slot, [&](int place, int node, auto count) {
      for (int n = 0; n < count; ++n)
        for (int k = 0; k < k_motion; ++k) nodes[place + n][k] = kinematics(node + n, k);
    });
    for (int n = 0; n < window; ++n)
      for (int k = k_motion; k < k_node; ++k) nodes[n][k] = 0;
    Stage stage;
    const Coord<Dim> from = origin(slot);
    stage.at_wall = reaches_wall(grid, from);
    if (stage.at_wall) mirror_images(grid, from, [&](int n) -> T* { return nodes[n]; });
    stage.one_body = of_one_body(soil, begin(slot * cells), begin((slot + 1) * cells));
    R moved = 0;
    for (int c = 0, end; c < cells; c = end) {  // as many whole cells as the stage holds
      const int from = begin(slot * cells + c);
      for (end = c + 1; end < cells && begin(slot * cells + end + 1) - from <= k_room;) ++end;
      if (begin(slot * cells + end) - from <= k_room)
        move_cells(nodes, slot, c, end, stage, moved);
      else
        move_crowd(nodes, slot, c, stage, moved);
    }
    return largest_of(moved);
  }

  using Window = const T (&)[window][k_node];

  void move_cells(Window nodes, int slot, int c, int end, Stage& stage, R& moved) const {
    const int from = begin(slot * cells + c), to = begin(slot * cells + end);
    for (int k = c; k < end; ++k)
      for (int p = begin(slot * cells + k); p < begin(slot * cells + k + 1); ++p)
        stage.base[p - from] = window_base<Dim>(k);
    take(nodes, from, to, stage);
    if (by.f_bar > 0) weigh_dilatation(from, to, stage);
    for (int k = c; k < end; ++k) {
      const int first = begin(slot * cells + k), last = begin(slot * cells + k + 1);
      if (by.f_bar_by_material) {
        average_by_material(
            soil, first, last, [&](int p) { return stage.mean[p - from]; },
            [&](int p, T of_cell) { stage.mean[p - from] = mean_of(p, of_cell, stage, p - from); });
        continue;
      }
      CellMean<T> dilatation;
      if (by.f_bar > 0) add_dilatation(first, last, stage, from, dilatation);
      const T mean = dilatation.value();
      for (int p = first; p < last; ++p) stage.mean[p - from] = mean;
    }
    for (int n = to - from; n % W != 0; ++n) stage.mean[n] = stage.mean[n - 1];
    for (int p = from; p < to; p += W) move_block(p, Kokkos::min(W, to - p), slot, stage, p - from, moved);
  }

  /// One cell with more particles than the stage holds: they take from the nodes twice.
  void move_crowd(Window nodes, int slot, int c, Stage& stage, R& moved) const {
    const int from = begin(slot * cells + c), to = begin(slot * cells + c + 1);
    const T mean = by.f_bar > 0 ? average_crowd(nodes, from, to, c, stage) : T(0);
    for (int first = from; first < to; first += k_room) {
      const int last = Kokkos::min(first + k_room, to);
      take_crowd(nodes, first, last, c, stage);
      for (int n = 0; n < k_room; ++n) stage.mean[n] = mean;
      for (int p = first; p < last && by.f_bar_by_material; ++p)
        stage.mean[p - first] = mean_of(p, dilatation(p), stage, p - first);
      for (int p = first; p < last; p += W)
        move_block(p, Kokkos::min(W, last - p), slot, stage, p - first, moved);
    }
  }
  void take_crowd(Window nodes, int first, int last, int c, Stage& stage) const {
    for (int n = 0; n < k_room; ++n) stage.base[n] = window_base<Dim>(c);
    take(nodes, first, last, stage);
  }
  /// Mean dilatation rate of the particles [from, to) of cell c [1/s]; where each material has its own, they
  /// are in `dilatation` by particle.
  T average_crowd(Window nodes, int from, int to, int c, Stage& stage) const {
    CellMean<T> all;
    for (int first = from; first < to; first += k_room) {
      const int last = Kokkos::min(first + k_room, to);
      take_crowd(nodes, first, last, c, stage);
      weigh_dilatation(first, last, stage);
      add_dilatation(first, last, stage, first, all);
      for (int p = first; p < last && by.f_bar_by_material; ++p) dilatation(p) = stage.mean[p - first];
    }
    if (by.f_bar_by_material)
      average_by_material(
          soil, from, to, [&](int p) { return dilatation(p); },
          [&](int p, T of_cell) { dilatation(p) = of_cell; });
    return all.value();
  }

  /// The particles [from, to) take from the nodes; the weights of many at once, then the values of a node at
  /// once.
  void take(Window nodes, int from, int to, Stage& stage) const {
    if (from == to) return;
    BodyProperties<R> body = body_of<R>(soil, from);
    for (int p = from; p < to; p += W) {
      const int count = Kokkos::min(W, to - p), n = p - from;
      Vector<R, Dim> x;
      load_field(soil.coordinate, p, count, x.c);
      if (!stage.one_body) body = bodies_of<R>(soil, p, count);
      const auto half = domains_of<domain, R, Dim>(soil, p, count, body);
      HostWeights<T, Dim, domain> weights;
      weights.find(x, half);
      for (int l = 0; l < W; ++l) {  // also those that only fill the lanes
        typename HostWeights<T, Dim, domain>::OfOne a;
        weights.take(l, a);
        take_one(nodes[stage.base[n + Kokkos::min(l, count - 1)] + weights.first(l)], a, n + l, stage);
      }
    }
  }

  /// Particle n of the stage, with the weights `a`; first: the lowest node that it reaches.
  template <class Weights>
  KOKKOS_INLINE_FUNCTION void take_one(const T* first, const Weights& a, int n, Stage& stage) const {
    Node value[1], gradient[1][slopes];
    sample_window<Dim>(first, a, value, gradient);
    stage.samples.put(n, value[0], gradient[0], by.inv_spacing, by.f_bar > 0);
  }

  /// Volume times dilatation rate of the particles [from, to) [m3/s], all of the stage, to stage.mean.
  void weigh_dilatation(int from, int to, Stage& stage) const {
    for (int p = from; p < to; p += W) {
      R volume;
      load_field(soil.volume, p, Kokkos::min(W, to - p), volume);
      (R::load(stage.samples.rate + (p - from)) * volume).store(stage.mean + (p - from));
    }
  }
  /// mean_for() of particle p, n on the stage.
  T mean_of(int p, T of_cell, const Stage& stage, int n) const {
    return mean_for(soil.materials(soil.material_of(p)).f_bar_share, of_cell, stage.samples.rate[n]);
  }
  /// Adds the dilatation rates of the particles [first, last). from: the first particle of the stage.
  void add_dilatation(int first, int last, const Stage& stage, int from, CellMean<T>& dilatation) const {
    for (int p = first; p < last; ++p) dilatation.add(soil.volume(p), stage.mean[p - from]);
  }

  /// `count` particles from p on, of the stage from n on; `moved` by lane.
  KOKKOS_INLINE_FUNCTION void move_block(int p, int count, int slot, const Stage& stage, int n,
                                         R& moved) const {
    Particle<R, Dim> q;
    for_each_value([&](auto& value, const auto& field)
                       MPM_INLINE_LAMBDA { load_field(field, p, count, value); },
                   q, soil);
    const GridSample<R, Dim, slopes> t = stage.samples.get(n);
    LawLanes<R, Space, T, Dim> law{.soil = soil, .p = p, .count = count, .one_law = stage.one_body};
    law.corner = origin(slot), law.spacing = spacing;
    for (int l = 0; l < (stage.one_body ? 1 : W); ++l)
      law.material[l] = soil.bodies(soil.body(p + Kokkos::min(l, count - 1))).material;
    if (alone(slot) != 0) law.flies = which_are_alone(p, count), law.some_fly = any_of(law.flies > 0);
    const R volume = q.volume, own = advance(q, law, t, R::load(stage.mean + n), by, domain_at(p, count));
    if (law.some_fly) q.volume = select(law.flies > 0, volume, q.volume);
    if (stage.at_wall) put_back_on_walls(q, p, count, slot);
    for_each_value([&](auto& value, const auto& field)
                       MPM_INLINE_LAMBDA { store_field(value, field, p, count); },
                   q, soil);
    const bool limited = by.volume_is_fault && any_of(is_volume_limited(q, by, domain_at(p, count)));
    if (limited || any_of(!(is_finite(q) & (own <= 1)))) find_faults(q, own, p, count, slot);
    moved = Kokkos::fmax(moved, own);
  }

  /// Domains of a block's particles, in the form that advance() takes.
  KOKKOS_FORCEINLINE_FUNCTION auto domain_at([[maybe_unused]] int p, [[maybe_unused]] int count) const {
    if constexpr (rings)
      return domains_of<domain, R, Dim>(soil, p, count, bodies_of<R>(soil, p, count));
    else
      return PlaneDomain{};
  }

  // Code that few blocks need is in separate functions that take and return values, so that the other blocks
  // keep their values in registers.

  /// 1 where a particle of the block is alone, else 0.
  [[gnu::noinline]] KOKKOS_FUNCTION R which_are_alone(int p, int count) const {
    R which = 0;
    for (int l = 0; l < count; ++l)
      if (is_alone(alone, soil.cell(p + l))) which.set(l, T(1));
    return which;
  }

  /// Particles of the block that have passed a wall are put on it (put_on_walls).
  KOKKOS_INLINE_FUNCTION void put_back_on_walls(Particle<R, Dim>& q, int p, int count, int slot) const {
    auto at_home = (q.x[0] >= 0) & (q.x[0] < 1);
    for (int d = 1; d < Dim; ++d) at_home = at_home & (q.x[d] >= 0) & (q.x[d] < 1);
    if (any_of(!at_home)) q = put_back_lanes(q, p, count, slot);  // no cell lies beyond a wall
  }
  [[gnu::noinline]] KOKKOS_FUNCTION Particle<R, Dim> put_back_lanes(Particle<R, Dim> q, int p, int count,
                                                                    int slot) const {
    for (int l = 0; l < count; ++l) {
      Vector<T, Dim> x, v;
      for (int d = 0; d < Dim; ++d) x[d] = q.x[d][l], v[d] = q.v[d][l];
      const bool passed = put_on_walls(grid, in_mesh(origin(slot), coord_of<Dim>(soil.cell(p + l))), x, v);
      for (int d = 0; d < Dim; ++d) q.x[d].set(l, x[d]), q.v[d].set(l, v[d]);
      if (passed) Kokkos::atomic_inc(&put_back(soil.body(p + l)));
    }
    return q;
  }

  [[gnu::noinline]] KOKKOS_FUNCTION void find_faults(const Particle<R, Dim> block, const R moved, int p,
                                                     int count, int slot) const {
    for (int l = 0; l < count; ++l) {
      Particle<T, Dim> q;
      for (int d = 0; d < Dim; ++d) q.x[d] = block.x[d][l], q.v[d] = block.v[d][l];
      q.volume = block.volume[l];
      for (int k = 0; k < sym_size<Dim>; ++k) q.stress[k] = block.stress[k][l];
      report_fault<domain>(control, soil, p + l, q, moved[l], by, origin(slot), spacing);
    }
  }
};

}  // namespace mpm
