#pragma once
// update_particles on a processor: a thread moves the particles of a patch, as many at once as an instruction
// takes.

#include "advance.hpp"
#include "host_window.hpp"
#include "state.hpp"

namespace mpm {

/// The materials of as many particles as R has lanes.
template <class R>
struct MaterialLanes {
  const AnyMaterial<typename R::real>* table;
  bool same;  // only which[0] is set
  int which[R::k_count];
};

/// Each law takes all lanes; those that are not of its material keep their state.
template <class R, class T, int Dim>
[[gnu::noinline]] KOKKOS_FUNCTION void update_materials(const MaterialLanes<R>& of,
                                                        MaterialState<R, Dim>& state,
                                                        const SymTensor<R, Dim>& d_strain,
                                                        const Spin<R, Dim>& d_spin, T dt) {
  const MaterialState<R, Dim> old = state;
  bool done[R::k_count] = {};
  for (int l = 0; l < R::k_count; ++l) {
    if (done[l]) continue;
    MaterialState<R, Dim> now = old;
    of.table[of.which[l]].visit([&](const auto& law) { law.update(now, d_strain, d_spin, dt); });
    R own = 0;
    for (int k = l; k < R::k_count; ++k)
      if (of.which[k] == of.which[l]) done[k] = true, own.set(k, T(1));
    const auto mine = own > 0;
    for (int k = 0; k < sym_size<Dim>; ++k) state.stress[k] = select(mine, now.stress[k], state.stress[k]);
    state.plastic_strain = select(mine, now.plastic_strain, state.plastic_strain);
    state.strength = select(mine, now.strength, state.strength);
  }
}
template <class R, class T, int Dim>
KOKKOS_FORCEINLINE_FUNCTION void update_material(const MaterialLanes<R>& of, MaterialState<R, Dim>& state,
                                                 const SymTensor<R, Dim>& d_strain,
                                                 const Spin<R, Dim>& d_spin, T dt) {
  if (of.same)
    of.table[of.which[0]].visit([&](const auto& law) { law.update(state, d_strain, d_spin, dt); });
  else
    update_materials(of, state, d_strain, d_spin, dt);
}

/// Moves the particles of patches.
template <class Space, class T, int Dim>
struct HostParticles {
  static constexpr int W = native_lanes<T>, cells = Patch<Dim>::cells, window = Patch<Dim>::window;
  using R = Lanes<T, W>;
  static constexpr int k_motion = NodeMotion<Dim>::size;
  static constexpr int k_node = k_motion <= 4 ? 4 : 8;  // values of a node, with a gap in 3D
  using Node = Lanes<T, k_node>;
  static constexpr int k_room = 2048 / sizeof(T);  // particles on the stage, which the cache holds
  static constexpr int k_pitch = k_room + W;       // not a power of two: values would drive each other out
  /// What the particles of some cells take from the nodes, in their order, each value apart.
  struct alignas(R) Stage {
    T motion[k_motion][k_pitch], gradient[Dim * Dim][k_pitch];  // m/s, m/s2; 1/s
    T mean[k_pitch];    // 1/s, dilatation rate of the particle's cell; first its share of it
    int base[k_pitch];  // window_base of its cell
    bool one_body;      // all particles of the patch
  };

  Soil<Space, T, Dim> soil;
  decltype(Bins<Space>::begin) begin;
  decltype(Patches<Space, Dim>::around) around;
  decltype(Patches<Space, Dim>::origin) origin;
  decltype(Nodes<Space, T, Dim>::motion) motion;
  ControlView<Space> control;
  UpdateScalars<T> by;
  double spacing;

  /// Asks for what the next slot takes from the nodes.
  void fetch_nodes(int slot) const {
    const int last = last_around<Dim>(around, slot);
    if (last >= 0) fetch(&motion(last * cells, 0), cells * k_motion * sizeof(T));
  }
  /// The particles of a slot. Returns the largest component of their movements [cells].
  T operator()(int slot) const {
    alignas(Node) T nodes[window][k_node];
    for_each_run<Dim>(around, slot, [&](int place, int node, auto count) {
      for (int n = 0; n < count; ++n)
        for (int k = 0; k < k_motion; ++k) nodes[place + n][k] = motion(node + n, k);
    });
    for (int n = 0; n < window; ++n)
      for (int k = k_motion; k < k_node; ++k) nodes[n][k] = 0;
    Stage stage;
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
      T volume = 0, sum = 0;
      const int first = begin(slot * cells + k), last = begin(slot * cells + k + 1);
      if (by.f_bar > 0) add_dilatation(first, last, stage, from, volume, sum);
      const T mean = volume > 0 ? sum / volume : T(0);
      for (int p = first; p < last; ++p) stage.mean[p - from] = mean;
    }
    for (int n = to - from; n % W != 0; ++n) stage.mean[n] = stage.mean[n - 1];
    for (int p = from; p < to; p += W) move_block(p, Kokkos::min(W, to - p), slot, stage, p - from, moved);
  }

  /// One cell with more particles than the stage holds: they take from the nodes twice.
  void move_crowd(Window nodes, int slot, int c, Stage& stage, R& moved) const {
    const int from = begin(slot * cells + c), to = begin(slot * cells + c + 1);
    T volume = 0, sum = 0;
    for (int pass = by.f_bar > 0 ? 0 : 1; pass < 2; ++pass)
      for (int first = from; first < to; first += k_room) {
        const int last = Kokkos::min(first + k_room, to);
        for (int n = 0; n < k_room; ++n) stage.base[n] = window_base<Dim>(c);
        take(nodes, first, last, stage);
        if (pass == 0) {
          weigh_dilatation(first, last, stage);
          add_dilatation(first, last, stage, first, volume, sum);
          continue;
        }
        for (int n = 0; n < k_room; ++n) stage.mean[n] = volume > 0 ? sum / volume : T(0);
        for (int p = first; p < last; p += W)
          move_block(p, Kokkos::min(W, last - p), slot, stage, p - first, moved);
      }
  }

  /// The particles [from, to) take from the nodes; the weights of many at once, then the values of a node at
  /// once.
  void take(Window nodes, int from, int to, Stage& stage) const {
    for (int p = from; p < to; p += W) {
      const int count = Kokkos::min(W, to - p), n = p - from;
      R x[Dim];
      load_field(soil.coordinate, p, count, x);
      const HalfLength<R> half = bodies_of<R>(soil, p, count, stage.one_body).half_length;
      alignas(R) T weight[Dim][2][3][W], shift[W];
      R to_first = 0;
      for (int d = 0, step = 1; d < Dim; ++d, step *= Patch<Dim>::window_edge) {
        const AxisWeights<R> a = axis_weights_near(x[d], half);
        for (int k = 0; k < 3; ++k) a.w[k].store(weight[d][0][k]), a.g[k].store(weight[d][1][k]);
        to_first += T(step) * (a.first + 1);
      }
      to_first.store(shift);
      for (int l = 0; l < W; ++l) {  // also those that only fill the lanes
        AxisWeights<T> a[Dim];
        for (int d = 0; d < Dim; ++d)
          for (int k = 0; k < 3; ++k) a[d].w[k] = weight[d][0][k][l], a[d].g[k] = weight[d][1][k][l];
        take_one(nodes[stage.base[n + Kokkos::min(l, count - 1)] + static_cast<int>(shift[l])], a, n + l,
                 stage);
      }
    }
  }

  /// Particle n of the stage, with the weights `a`; first: the lowest node that it reaches.
  KOKKOS_INLINE_FUNCTION void take_one(const T* first, const AxisWeights<T> (&a)[Dim], int n,
                                       Stage& stage) const {
    constexpr int across = Patch<Dim>::window_edge;
    Node value[1] = {T(0)}, gradient[1][Dim] = {};
    for (int d = 0; d < Dim; ++d) gradient[0][d] = T(0);
    interpolate_by_lines(
        a,
        [&](const Vector<int, Dim>& k) {
          const int place = k[0] + across * (k[1] + (Dim == 3 ? across * k[Dim - 1] : 0));
          struct {
            Node v;
            KOKKOS_INLINE_FUNCTION const Node& operator[](int) const { return v; }
          } node{Node::load(first + place * k_node)};
          return node;
        },
        value, gradient);
    for (int k = 0; k < k_motion; ++k) stage.motion[k][n] = value[0][k];
    for (int i = 0; i < Dim; ++i)
      for (int d = 0; d < Dim; ++d) stage.gradient[i * Dim + d][n] = gradient[0][d][i] * by.inv_spacing;
  }

  /// Volume times dilatation rate of the particles [from, to) [m3/s], all of the stage, to stage.mean.
  void weigh_dilatation(int from, int to, Stage& stage) const {
    for (int p = from; p < to; p += W) {
      R volume[1], rate = 0;
      load_field(soil.volume, p, Kokkos::min(W, to - p), volume);
      for (int d = 0; d < Dim; ++d) rate += R::load(stage.gradient[d * (Dim + 1)] + (p - from));
      (rate * volume[0]).store(stage.mean + (p - from));
    }
  }
  /// Adds the volumes [m3] of the particles [first, last), and with their dilatation rates [m3/s]. from: the
  /// first particle of the stage.
  void add_dilatation(int first, int last, const Stage& stage, int from, T& volume, T& sum) const {
    for (int p = first; p < last; ++p) {
      volume += soil.volume(p);
      sum += stage.mean[p - from];
    }
  }

  /// `count` particles from p on, of the stage from n on; `moved` by lane.
  KOKKOS_INLINE_FUNCTION void move_block(int p, int count, int slot, const Stage& stage, int n,
                                         R& moved) const {
    Particle<R, Dim> q;
    R volume[1], plastic_strain[1], strength[1];
    load_field(soil.coordinate, p, count, q.x.c);
    load_field(soil.velocity, p, count, q.v.c);
    load_field(soil.stress, p, count, q.material.stress.c);
    load_field(soil.volume, p, count, volume);
    load_field(soil.plastic_strain, p, count, plastic_strain);
    load_field(soil.strength, p, count, strength);
    q.volume = volume[0], q.material.plastic_strain = plastic_strain[0], q.material.strength = strength[0];
    Taken<R, Dim> t;
    for (int k = 0; k < k_motion; ++k) t.motion[k] = R::load(stage.motion[k] + n);
    for (int k = 0; k < Dim * Dim; ++k) t.gradient[k / Dim][k % Dim] = R::load(stage.gradient[k] + n);
    MaterialLanes<R> materials;
    materials.table = soil.materials.data(), materials.same = stage.one_body;
    for (int l = 0; l < (stage.one_body ? 1 : W); ++l)
      materials.which[l] = soil.bodies(soil.body(p + Kokkos::min(l, count - 1))).material;
    const R own = advance(q, materials, t, R::load(stage.mean + n), by);
    store_field(q.x.c, soil.coordinate, p, count);
    store_field(q.v.c, soil.velocity, p, count);
    store_field(q.material.stress.c, soil.stress, p, count);
    volume[0] = q.volume;
    store_field(volume, soil.volume, p, count);
    if (any_of(q.material.plastic_strain != plastic_strain[0])) {
      plastic_strain[0] = q.material.plastic_strain;
      store_field(plastic_strain, soil.plastic_strain, p, count);
    }
    if (any_of(!(is_finite(q) & (q.volume > 0) & (own <= 1)))) find_faults(q, own, p, count, slot);
    moved = Kokkos::fmax(moved, own);
  }

  [[gnu::noinline]] KOKKOS_FUNCTION void find_faults(const Particle<R, Dim>& block, const R& moved, int p,
                                                     int count, int slot) const {
    for (int l = 0; l < count; ++l) {
      Particle<T, Dim> q;
      for (int d = 0; d < Dim; ++d) q.x[d] = block.x[d][l], q.v[d] = block.v[d][l];
      q.volume = block.volume[l];
      for (int k = 0; k < sym_size<Dim>; ++k) q.material.stress[k] = block.material.stress[k][l];
      const FaultKind fault = fault_of(q, moved[l]);
      if (fault == FaultKind::none) continue;
      const Coord<Dim> cell = coord_of<Dim>(soil.cell(p + l));
      double position[3] = {};
      for (int d = 0; d < Dim; ++d) position[d] = (double(origin(slot)[d]) + cell[d] + q.x[d]) * spacing;
      report(control, fault, soil.id(p + l), position, Dim);
    }
  }
};

}  // namespace mpm
