#pragma once
// Bounds of the volume of a particle by its own mass. The step keeps volumes within those of any particle
// (advance); where particles are unequal, as parts of cells and pieces are, a small one could grow there far
// beyond its own, and its stress would throw it about.

#include "data/state.hpp"

namespace mpm {

/// Least and most volume of a particle [m3].
template <class T>
struct VolumeBounds {
  T least, most;
};

/// Those of particle p: k_least_volume and k_most_volume times its volume at the start. start_volume:
/// Strays::start_volume
template <class Start, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION VolumeBounds<T> own_volume_bounds(const Start& start_volume,
                                                         const Soil<Space, T, Dim>& soil, int p) {
  double start = 0;
  if (start_volume.extent(0) > 0) start = start_volume(soil.body(p)) * double(soil.properties(p).mass);
  if (!(start > 0)) return {T(0), Kokkos::Experimental::infinity_v<T>};
  return {static_cast<T>(k_least_volume * start), static_cast<T>(k_most_volume * start)};
}

/// Brings volumes within their own bounds, before the particles' new places are found; does nothing where the
/// bounds of any particle are those of each. With StrayRule::stop one that was beyond them is a fault.
template <class Space, class T, int Dim>
void limit_volumes(State<Space, T, Dim>& s);

}  // namespace mpm
