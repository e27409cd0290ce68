#include "loops/particle_to_node.hpp"

namespace mpm {

/// Brings a point to where it is now, if its source can.
template <class Source>
KOKKOS_INLINE_FUNCTION void move_point([[maybe_unused]] const Source& source, [[maybe_unused]] int p) {
  if constexpr (requires { source.move(p); }) source.move(p);
}

template <class Source>
void scatter_atomic(const Interpolation<Source>& it) {
  using T = typename Source::real;
  const auto source = it.source;
  const NodePlaces places(it.grid, it.patches);
  const auto out = it.out;
  const auto control = it.control;
  Kokkos::parallel_for(
      "mpm::scatter_atomic",
      light(Kokkos::RangePolicy<typename Source::Space>(it.space, 0, source.points.count)),
      KOKKOS_LAMBDA(int p) {
        if (control().paused) return;
        move_point(source, p);
        give_to_nodes(source, places, p, [&](int i, int k, T v) { Kokkos::atomic_add(&out(i, k), v); });
      });
}

#define MPM_STRATEGY scatter_atomic
MPM_FOR_EACH(MPM_INSTANTIATE_STRATEGY)

}  // namespace mpm
