#include "rebuild/limit_volumes.hpp"

#include "rebuild/batches.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void limit_volumes(Core<Space, T, Dim>& s) {
  const auto start_volume = s.strays.start_volume;
  if (start_volume.extent(0) == 0) return;
  collect_soil(s);
  const auto soil = s.soil.points;
  const auto origin = s.patches.origin;
  const auto control = s.control;
  const double spacing = s.spacing;
  const bool stops = s.strays.rule == StrayRule::stop;
  Kokkos::parallel_for(
      "mpm::limit_volumes", Kokkos::RangePolicy<Space>(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
        const T volume = soil.volume(p);
        const VolumeBounds<T> own = own_volume_bounds(start_volume, soil, p);
        if (volume >= own.least && volume <= own.most) return;
        const T most = volume > own.most ? own.most * gap_room(soil, p) : own.most;
        soil.volume(p) = Kokkos::fmin(most, Kokkos::fmax(own.least, volume));
        if (!stops) return;
        const int cell = soil.cell(p);
        const Coord<Dim> from = origin(cell / Patch<Dim>::cells), in = coord_of<Dim>(cell);
        double position[3] = {};
        for (int d = 0; d < Dim; ++d)
          position[d] = (double(from[d]) + in[d] + soil.coordinate(p)[d]) * spacing;
        report(control, FaultKind::volume, soil.id(p), position, Dim);
      });
}

#define MPM_INSTANTIATE(Space, T, Dim) template void limit_volumes(Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
