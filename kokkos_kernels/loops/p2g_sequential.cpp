#include "loops/particle_to_node.hpp"

namespace mpm {

template <class Source>
void scatter_sequential(const Interpolation<Source>& it) {
  using T = typename Source::real;
  const auto source = it.source;
  const NodePlaces places(it.grid, it.patches);
  const auto out = it.out;
  const auto control = it.control;
  Kokkos::parallel_for(
      "mpm::scatter_sequential", light(Kokkos::RangePolicy<typename Source::Space>(it.space, 0, 1)),
      KOKKOS_LAMBDA(int) {
        if (control().paused) return;
        for (int p = 0; p < source.points.count; ++p)
          give_to_nodes(source, places, p, [&](int i, int k, T v) { out(i, k) += v; });
      });
}

#define MPM_STRATEGY scatter_sequential
MPM_FOR_EACH(MPM_INSTANTIATE_STRATEGY)

}  // namespace mpm
