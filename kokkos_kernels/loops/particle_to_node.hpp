#pragma once
// Interpolation from particles to nodes (functions 2 and 3 of the paper): one source, five loop shapes.

#include "base/choices.hpp"
#include "base/spaces.hpp"
#include "physics/flow_source.hpp"
#include "physics/p2g_terms.hpp"

namespace mpm {

/// Everything that an interpolation needs.
template <class Source>
struct Interpolation {
  using Space = typename Source::Space;
  using T = typename Source::real;
  static constexpr int Dim = Source::dim;

  Space space;
  Grid<T, Dim> grid;
  Patches<Space, Dim> patches;
  Bins<Space> bins;
  Source source;
  NodeField<Space, T, Source::size> out;
  ControlView<Space> control;
  int mosaic_cells = 3;
  Windows<Space> windows = {};
  bool adds = true;  // to what `out` holds, which `reset_nodes` cleared; else it is written, all of it
  /// The slots whose nodes matter, if some_count is not negative; else those of all do.
  Kokkos::View<int*, typename Space::memory_space> some_slots = {};
  int some_count = -1;
  int giving = -1;  // number of slots whose points give, if it is not negative; else those of all do
  /// These slots, where the bins are those of the whole soil.
  Kokkos::View<int*, typename Space::memory_space> giving_slots = {};
};

/// The strategy for the points of rigids. They are few in many cells of a patch or many in few: where `tile`
/// would leave most of a GPU's threads idle, a thread a point does not.
template <class Space>
P2G strategy_of_rigids(P2G chosen_for_soil) {
  const bool tile = chosen(chosen_for_soil) == P2G::tile;
  return is_device<Space> && tile ? P2G::atomic : chosen_for_soil;
}
/// Whether a strategy moves the points of a rigid itself, since it takes each of them once.
constexpr bool moves_points(P2G how) { return how == P2G::atomic; }

template <class Source>
void scatter_sequential(const Interpolation<Source>&);  // one thread, particle by particle
template <class Source>
void scatter_atomic(const Interpolation<Source>&);  // a thread a particle, atomic additions
template <class Source>
void scatter_mosaic(const Interpolation<Source>&);  // a thread a block of cells, colour by colour
template <class Source>
void gather_by_node(const Interpolation<Source>&);  // a thread a node, over its expanded list of particles
template <class Source>
void reduce_by_tile(const Interpolation<Source>&);  // a team a patch, in scratch memory

/// The switch of -p2g.
template <class Source>
void particle_to_node(P2G how, const Interpolation<Source>& it) {
  if (it.source.points.count == 0 && it.adds) return;
  switch (chosen(how)) {
    case P2G::sequential: return scatter_sequential(it);
    case P2G::atomic: return scatter_atomic(it);
    case P2G::mosaic: return scatter_mosaic(it);
    case P2G::gather: return gather_by_node(it);
    default: return reduce_by_tile(it);
  }
}

/// Number of blocks of `edge` cells along direction d. Round a period there are as many blocks of one colour
/// as of the other, of `edge` cells or some more; or there is one.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION int blocks_along(const Grid<T, Dim>& grid, int d, int edge) {
  if (grid.period[d] == 0) return (grid.cells[d] + edge - 1) / edge;
  return Kokkos::max(1, grid.cells[d] / (2 * edge) * 2);
}
/// First cell of block b of so many along direction d.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION int begin_of_block(const Grid<T, Dim>& grid, int d, int edge, int b, int along) {
  if (grid.period[d] == 0) return Kokkos::min(b * edge, grid.cells[d]);
  return static_cast<int>(long(b) * grid.cells[d] / along);
}

/// Calls f(cell, field) for every cell of the mosaic's block number b; blocks are numbered first direction
/// fastest, and those of a velocity field behind those of the field before it.
template <class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void for_each_cell_of_block(const Grid<T, Dim>& grid, long b, int edge, F&& f) {
  Coord<Dim> low{}, high{};
  for (int d = 0; d < Dim; ++d) {
    const int along = blocks_along(grid, d, edge);
    const int block = static_cast<int>(b % along);
    low[d] = begin_of_block(grid, d, edge, block, along);
    high[d] = begin_of_block(grid, d, edge, block + 1, along);
    b /= along;
  }
  Coord<Dim> c = low;
  for (int z = Dim == 3 ? low[Dim - 1] : 0; z < (Dim == 3 ? high[Dim - 1] : 1); ++z)
    for (c[1] = low[1]; c[1] < high[1]; ++c[1])
      for (c[0] = low[0]; c[0] < high[0]; ++c[0]) {
        if constexpr (Dim == 3) c[2] = z;
        f(c, static_cast<int>(b));
      }
}

/// Places of the nodes, by which a particle finds its own nodes.
template <class Space, class T, int Dim>
struct NodePlaces {
  using Memory = typename Space::memory_space;
  Grid<T, Dim> grid;
  Kokkos::View<Coord<Dim>*, Memory> origin;
  decltype(Patches<Space, Dim>::neighbours) neighbours;

  NodePlaces(const Grid<T, Dim>& mesh, const Patches<Space, Dim>& patches)
      : grid(mesh), origin(patches.origin), neighbours(patches.neighbours) {}
};

/// The nodes that a particle reaches from the cell where it was binned; of those beyond a wall their images,
/// with the signs that values of this kind have there.
template <Kind kind, class T, int Dim>
struct Stencil {
  static constexpr bool k_turns_all = kind == Kind::motion;  // at a fixed side every component
  int slot;
  int which[Dim][3];                       // part of each axis in the number of the patch around
  int place[Dim][3];                       // part of each axis in the place in that patch
  T normal[Dim][3];                        // factor of the component along the axis, as image_sign
  T tangential[k_turns_all ? Dim : 1][3];  // factor of the others, where it may be another than 1

  /// a: the weights along each axis.
  template <class Space, class Weights>
  KOKKOS_INLINE_FUNCTION Stencil(const NodePlaces<Space, T, Dim>& places, int cell, const Weights& a)
      : slot(cell / Patch<Dim>::cells) {
    const Coord<Dim> c = coord_of<Dim>(cell), from = places.origin(slot);
    for (int d = 0, step = 1; d < Dim; ++d, step *= 3)
      for (int k = 0; k < 3; ++k) {
        const int at = from[d] + c[d] + a[d].first + k, n = image_along(places.grid, d, at) - from[d];
        which[d][k] = ((n >> Patch<Dim>::log_edge) + 1) * step;
        place[d][k] = (n & (Patch<Dim>::edge - 1)) << (d * Patch<Dim>::log_edge);
        normal[d][k] = image_sign<kind, T>(places.grid, d, at, d);
        if constexpr (k_turns_all) tangential[d][k] = image_sign<kind, T>(places.grid, d, at, (d + 1) % Dim);
      }
  }
  template <class Neighbours>
  KOKKOS_INLINE_FUNCTION int node(const Neighbours& neighbours, const Vector<int, Dim>& k) const {
    int w = which[0][k[0]], p = place[0][k[0]];
    for (int d = 1; d < Dim; ++d) w += which[d][k[d]], p += place[d][k[d]];
    return neighbours(slot, w) * Patch<Dim>::cells + p;
  }
  /// Sign that a component of a vector, or a scalar (-1), of node() has at the node k steps from the first.
  KOKKOS_INLINE_FUNCTION T sign(const Vector<int, Dim>& k, int component) const {
    if (component < 0) return 1;
    T sign = 1;
    for (int d = 0; d < Dim; ++d) {
      if (d == component)
        sign *= normal[d][k[d]];
      else if constexpr (k_turns_all)
        sign *= tangential[d][k[d]];
    }
    return sign;
  }
};

/// Calls f(node, w, grad, offset, sign) for every node of the box with the centre x [cells, in the frame of a
/// cell]: w [-] its weight, grad [1/cell] its gradient, offset() [cells] from x to it; sign(component) as
/// Stencil::sign. Nodes of no weight are left alone, which keeps the blocks of one colour apart.
template <Kind kind, class Domain, class Space, class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void for_each_node_at(const Vector<T, Dim>& x, int cell, const Domain& domain,
                                             const NodePlaces<Space, T, Dim>& places, F&& f) {
  with_weights(x, domain, [&](const auto& a) {
    const Stencil<kind, T, Dim> stencil(places, cell, a);
    for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const auto& grad) {
      if (!(w > 0)) return;
      f(
          stencil.node(places.neighbours, k), w, grad, [&] { return offset_to(x, a, k); },
          [&](int component) { return stencil.sign(k, component); });
    });
  });
}
/// Calls f for every node of particle p.
template <Kind kind, class Points_, class Domain, class Space, class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void for_each_node(const Points_& points, const Domain& domain,
                                          const NodePlaces<Space, T, Dim>& places, int p, F&& f) {
  for_each_node_at<kind>(points.coordinate(p), points.cell(p), domain, places, f);
}

/// Gives the terms of particle p to its nodes by add(node, value index, value).
template <class Source, class Space, class T, int Dim, class Add>
KOKKOS_INLINE_FUNCTION void give_to_nodes(const Source& source, const NodePlaces<Space, T, Dim>& places,
                                          int p, Add&& add) {
  if (source.skips(source.points.cell(p) / Patch<Dim>::cells)) return;
  const typename Source::Point q = source.load(p);
  for_each_node<Source::kind>(
      source.points, q.half_length, places, p, [&](int i, T w, const auto& grad, auto&& offset, auto&& sign) {
        give<Source>(q, w, grad, offset,
                     [&](int value, T v) { add(i, value, sign(Source::component(value)) * v); });
      });
}

}  // namespace mpm

/// Instantiates a strategy for every source, space, real type and dimension.
#define MPM_INSTANTIATE_SOURCE(...) template void MPM_STRATEGY(const Interpolation<__VA_ARGS__>&);
#define MPM_INSTANTIATE_STRATEGY(Space, T, Dim) MPM_FOR_EACH_SOURCE(MPM_INSTANTIATE_SOURCE, Space, T, Dim)
