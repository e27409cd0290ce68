#include "contact.hpp"
#include "particle_to_node.hpp"
#include "step_kernels.hpp"

namespace mpm {

// The minimum does not depend on the order of the particles, so one loop serves every strategy.
template <class Space, class T, int Dim>
void measure_gaps(const State<Space, T, Dim>& s) {
  const auto soil = s.soil.points;
  const auto origin = s.patches.origin;
  const auto around = s.patches.around;
  const auto near = s.near_rigid;
  const auto gap = s.nodes.gap;
  const auto rigids = s.rigids;
  const auto vertices = s.vertices;
  const auto control = s.control;
  const double spacing = s.spacing;
  const int count = static_cast<int>(s.rigid_points.size());
  Kokkos::parallel_for(
      "mpm::measure_gaps", light(Kokkos::RangePolicy<Space>(s.space, 0, soil.count)), KOKKOS_LAMBDA(int p) {
        const int slot = soil.cell(p) / Patch<Dim>::cells;
        if (control().paused || near(slot) == 0) return;
        const Coord<Dim> cell = coord_of<Dim>(soil.cell(p));
        const Vector<T, Dim> x_p = soil.coordinate(p);
        const T l = soil.bodies(soil.body(p)).half_length;
        for (int r = 0; r < count; ++r) {
          if (!(rigids(r).reach > 0)) continue;
          Vector<double, Dim> x;
          for (int d = 0; d < Dim; ++d)
            x[d] = (double(origin(slot)[d]) + cell[d] + x_p[d]) * spacing - rigids(r).displacement[d];
          const T own = static_cast<T>(distance_to(rigids(r).surface, vertices, x).value - l * spacing);
          with_weights(x_p, l, [&](const AxisWeights<T>(&a)[Dim]) {
            const Stencil<Dim> stencil(soil.cell(p), a);
            for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const Vector<T, Dim>&) {
              if (w > 0) Kokkos::atomic_min(&gap(r, stencil.node(around, k)), own);
            });
          });
        }
      });
}

#define MPM_INSTANTIATE(Space, T, Dim) template void measure_gaps(const State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
