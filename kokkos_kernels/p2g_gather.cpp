#include "particle_to_node.hpp"

namespace mpm {

/// Half length of a point [cells], soil or rigid.
template <class Points_>
KOKKOS_INLINE_FUNCTION auto half_length_of(const Points_& points, int p) {
  if constexpr (requires { points.bodies; })
    return points.bodies(points.body(p)).half_length;
  else
    return points.half_length;
}

// The sums of a node are made in the order of its list, so the result has the same bits on every run.
template <class Source>
void gather_by_node(const Interpolation<Source>& it) {
  using T = typename Source::real;
  constexpr int Dim = Source::dim;
  const auto source = it.source;
  const auto origin = it.patches.origin;
  const auto list_begin = it.bins.list_begin;
  const auto list = it.bins.list;
  const auto out = it.out;
  const auto control = it.control;
  // Neighbouring nodes ask for the same particles, and the caches of a GPU hold those of so many threads
  // only.
  constexpr int k_share_of_threads = 40;  // %
  const Kokkos::RangePolicy<typename Source::Space> nodes(it.space, 0, it.patches.node_count());
  Kokkos::parallel_for(
      "mpm::gather_by_node",
      light(Kokkos::Experimental::prefer(nodes, Kokkos::Experimental::DesiredOccupancy(k_share_of_threads))),
      KOKKOS_LAMBDA(int i) {
        if (control().paused) return;
        const int first = list_begin(i), last = list_begin(i + 1);
        if (first == last) return;
        const Coord<Dim> at = origin(i / Patch<Dim>::cells), in = coord_of<Dim>(i);
        T sum[Source::size] = {};
        for (int n = first; n < last; ++n) {
          const int p = list(n), cell = source.points.cell(p);
          if (source.skips(cell / Patch<Dim>::cells)) continue;
          const Coord<Dim> from = origin(cell / Patch<Dim>::cells), place = coord_of<Dim>(cell);
          Vector<T, Dim> x = source.points.coordinate(p);
          const auto half_length = half_length_of(source.points, p);
          T s[Dim], ds[Dim];
          for (int d = 0; d < Dim; ++d) {
            x[d] += from[d] + place[d] - at[d] - in[d];  // from the node
            node_weight(x[d], half_length, s[d], ds[d]);
          }
          T w = 1;
          for (int d = 0; d < Dim; ++d) w *= s[d];
          if (!(w > 0)) continue;  // the list holds what may come here till the next rebuild
          Vector<T, Dim> grad;
          for (int d = 0; d < Dim; ++d) {
            grad[d] = ds[d];
            for (int e = 0; e < Dim; ++e) grad[d] *= e == d ? T(1) : s[e];
          }
          const auto offset = [&] {
            Vector<T, Dim> r;
            for (int d = 0; d < Dim; ++d) r[d] = -x[d];
            return r;
          };
          give<Source>(source.load(p), w, grad, offset, [&](int k, T v) { sum[k] += v; });
        }
        for (int k = 0; k < Source::size; ++k) out(i, k) += sum[k];
      });
}

#define MPM_STRATEGY gather_by_node
MPM_FOR_EACH(MPM_INSTANTIATE_STRATEGY)

}  // namespace mpm
