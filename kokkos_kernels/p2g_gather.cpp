#include "particle_to_node.hpp"

namespace mpm {

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
  Kokkos::parallel_for(
      "mpm::gather_by_node",
      light(Kokkos::RangePolicy<typename Source::Space>(it.space, 0, it.patches.node_count())),
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
          const typename Source::Point q = source.load(p);
          T s[Dim], ds[Dim];
          for (int d = 0; d < Dim; ++d) {
            x[d] += from[d] + place[d] - at[d] - in[d];  // from the node
            node_weight(x[d], q.half_length, s[d], ds[d]);
          }
          T w = 1;
          Vector<T, Dim> grad;
          for (int d = 0; d < Dim; ++d) {
            w *= s[d];
            grad[d] = ds[d];
            for (int e = 0; e < Dim; ++e) grad[d] *= e == d ? T(1) : s[e];
          }
          const auto offset = [&] {
            Vector<T, Dim> r;
            for (int d = 0; d < Dim; ++d) r[d] = -x[d];
            return r;
          };
          if (w > 0) give<Source>(q, w, grad, offset, [&](int k, T v) { sum[k] += v; });
        }
        for (int k = 0; k < Source::size; ++k) out(i, k) += sum[k];
      });
}

#define MPM_STRATEGY gather_by_node
MPM_FOR_EACH(MPM_INSTANTIATE_STRATEGY)

}  // namespace mpm
