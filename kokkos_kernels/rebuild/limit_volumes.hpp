#pragma once
// Bounds of the volume of a particle by its own mass. The bounds of a step (advance) come from the smallest
// and the largest particle of the run. Parts of cells and split particles are smaller: within the bounds of a
// step such a particle could grow to many times its volume, and its stress would throw it about.

#include "data/core.hpp"
#include "physics/gap_room.hpp"
#include "physics/ring_domain.hpp"

namespace mpm {

/// Least and most volume of a particle [m3]; the latter without its gap_room().
template <class T>
struct VolumeBounds {
  T least, most;
};

/// Bounds of particle p: k_least_volume and k_most_volume times its volume at the start. start_volume:
/// Strays::start_volume
template <class Start, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION VolumeBounds<T> own_volume_bounds(const Start& start_volume,
                                                         const Soil<Space, T, Dim>& soil, int p) {
  double start = 0;
  if (start_volume.extent(0) > 0) start = start_volume(soil.body(p)) * double(soil.properties(p).mass);
  if (!(start > 0)) return {T(0), Kokkos::Experimental::infinity_v<T>};
  return {static_cast<T>(k_least_volume * start), static_cast<T>(k_most_volume * start)};
}

/// Whether the volume of particle p has come to a bound of all particles, or to one of its own.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION bool is_volume_at_bound(const VolumeBounds<T>& of_all, const VolumeBounds<T>& own,
                                               const Soil<Space, T, Dim>& soil, int p, T spacing) {
  const T volume = soil.volume(p), size = bounded_volume(soil, p, spacing);
  if (size <= of_all.least || volume <= own.least) return true;
  if (size < of_all.most && volume < own.most) return false;
  const T room = gap_room(soil, p);
  return size >= of_all.most * room || volume >= own.most * room;
}

/// Brings volumes within own_volume_bounds() at a rebuild, before locate(); does nothing where
/// Strays::start_volume is not in use. With StrayRule::stop a volume that was beyond them is a fault.
template <class Space, class T, int Dim>
void limit_volumes(Core<Space, T, Dim>& s);

}  // namespace mpm
