#include "data/core.hpp"
#include "functions/step_kernels.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void add_buoyancy(Core<Space, T, Dim>& s) {
  const auto soil = s.nodes.soil;
  const auto displaced = s.nodes.displaced;
  const auto control = s.control;
  Vector<T, Dim> g;
  for (int d = 0; d < Dim; ++d) g[d] = static_cast<T>(s.gravity[d]);
  Kokkos::parallel_for(
      "mpm::add_buoyancy", light(Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count())),
      KOKKOS_LAMBDA(int i) {
        if (control().paused) return;
        for (int d = 0; d < Dim; ++d)
          soil(i, SoilTerms<Dim>::force + d) -= displaced(i, DisplacedTerms::mass) * g[d];
      });
}

#define MPM_INSTANTIATE(Space, T, Dim) template void add_buoyancy(Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
