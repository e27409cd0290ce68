#include "loops/particle_to_node.hpp"

namespace mpm {

/// Half lengths of a point of a source [cells], soil or rigid.
template <class Source>
KOKKOS_INLINE_FUNCTION auto half_length_of(const Source& source, int p) {
  const auto& points = source.points;
  if constexpr (!requires { points.bodies; })
    return points.half_length;
  else if constexpr (Source::domain == ParticleDomain::fixed)
    return points.bodies(points.body(p)).half_length;
  else
    return box_or_ring_of<Source::domain>(points, p, points.bodies(points.body(p)));
}

/// Sums the terms of the particles in the list of a node, and in those of its images beyond walls. Periodic:
/// the node may lie beyond a periodic side of its particles.
template <class Source, bool Periodic>
struct GatherByNode {
  using T = typename Source::real;
  using Memory = typename Source::Space::memory_space;
  static constexpr int Dim = Source::dim;
  Source source;
  NodePlaces<typename Source::Space, T, Dim> places;
  Kokkos::View<int*, Memory> list_begin, list;
  NodeField<typename Source::Space, T, Source::size> out;
  ControlView<typename Source::Space> control;

  // The sums of a node are made in the order of its list, so the result has the same bits on every run.
  KOKKOS_FUNCTION void operator()(int i) const {
    if (control().paused) return;
    const Coord<Dim> from = places.origin(i / Patch<Dim>::cells), in = coord_of<Dim>(i);
    T sum[Source::size] = {};
    bool some = false;
    // Along each axis the node itself, its image in the lower wall, and that in the upper one.
    for (int images = 0; images < power(3, Dim); ++images) {
      Coord<Dim> at;
      bool is = true;
      for (int d = 0, rest = images; d < Dim; ++d, rest /= 3)
        is = is && image_of(d, from[d] + in[d], rest % 3, at[d]);
      if (!is) continue;
      Coord<Dim> place;
      for (int d = 0; d < Dim; ++d) place[d] = at[d] - from[d];
      const int node =
          number_at<decltype(places.neighbours), Dim>(places.neighbours, i / Patch<Dim>::cells, place);
      if (node >= 0) some |= add_list(node, at, sum);
    }
    if (!some) return;
    for (int k = 0; k < Source::size; ++k) out(i, k) += sum[k];
  }

  /// The coordinate of a node at `own` along d, or of what is its image in a wall. False where there is none,
  /// and for a node that lies beyond a wall itself.
  KOKKOS_INLINE_FUNCTION bool image_of(int d, int own, int which, int& at) const {
    const auto& grid = places.grid;
    if (image_along(grid, d, own) != own) return false;
    at = which == 0 ? own : which == 1 ? -1 : grid.cells[d] + 1;
    return which == 0 || (at != own && image_along(grid, d, at) == own);
  }

  /// Adds the terms of the particles in the list of a node at `at`, with the signs of its image. False if
  /// there are none.
  KOKKOS_INLINE_FUNCTION bool add_list(int node, const Coord<Dim>& at, T (&sum)[Source::size]) const {
    T sign[Source::size];
    for (int v = 0; v < Source::size; ++v) {
      sign[v] = 1;
      for (int d = 0; d < Dim; ++d)
        sign[v] *= image_sign<Source::kind, T>(places.grid, d, at[d], Source::component(v));
    }
    const int first = list_begin(node), last = list_begin(node + 1);
    for (int n = first; n < last; ++n)
      add_point(list(n), at, [&](int v, T term) { sum[v] += sign[v] * term; });
    return last > first;
  }

  /// From the node to the cell of a particle that may come to reach it, two cells below it to one above,
  /// along direction d; `way` leads there in the mesh.
  KOKKOS_INLINE_FUNCTION int from_node(int d, int way) const {
    if constexpr (Periodic) {
      if (way < -2) return way + places.grid.period[d];
      if (way > 1) return way - places.grid.period[d];
    }
    return way;
  }

  template <class Add>
  KOKKOS_INLINE_FUNCTION void add_point(int p, const Coord<Dim>& at, const Add& add) const {
    const int cell = source.points.cell(p);
    if (source.skips(cell / Patch<Dim>::cells)) return;
    const Coord<Dim> from = places.origin(cell / Patch<Dim>::cells), place = coord_of<Dim>(cell);
    Vector<T, Dim> x = source.points.coordinate(p);
    for (int d = 0; d < Dim; ++d) x[d] += from_node(d, from[d] + place[d] - at[d]);
    auto domain = half_length_of(source, p);
    if constexpr (requires { domain.axis_x; }) domain.axis_x = -at[0];
    Vector<T, k_slopes_of<Source>> grad;
    const T w = single_node_weight(x, domain, grad);
    if (!(w > 0)) return;  // the list holds what may come here till the next rebuild
    give<Source>(
        source.load(p), w, grad, [&] { return offset_from(x, domain); }, add);
  }
};

template <bool Periodic, class Source>
void gather(const Interpolation<Source>& it) {
  // Neighbouring nodes ask for the same particles, and the caches of a GPU hold those of so many threads
  // only.
  constexpr int k_share_of_threads = 40;  // %
  const Kokkos::RangePolicy<typename Source::Space> nodes(it.space, 0, it.patches.node_count());
  Kokkos::parallel_for(
      "mpm::gather_by_node",
      light(Kokkos::Experimental::prefer(nodes, Kokkos::Experimental::DesiredOccupancy(k_share_of_threads))),
      GatherByNode<Source, Periodic>{
          it.source, {it.grid, it.patches}, it.bins.list_begin, it.bins.list, it.out, it.control});
}

template <class Source>
void gather_by_node(const Interpolation<Source>& it) {
  if (it.grid.is_periodic())
    gather<true>(it);
  else
    gather<false>(it);
}

#define MPM_STRATEGY gather_by_node
MPM_FOR_EACH(MPM_INSTANTIATE_STRATEGY)

}  // namespace mpm
