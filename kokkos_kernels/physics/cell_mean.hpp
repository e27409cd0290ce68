#pragma once
// Means over the particles of a cell, for F-bar: of all of them, or of those of each material.

#include "data/particles.hpp"

namespace mpm {

/// Mean over the particles of a cell, weighted by volume.
template <class T>
struct CellMean {
  T volume = 0, sum = 0;  // m3; m3 times the unit of what is averaged

  /// weighted: the particle's volume times its value.
  KOKKOS_INLINE_FUNCTION void add(T of_particle, T weighted) { volume += of_particle, sum += weighted; }
  /// 0 in an empty cell.
  KOKKOS_INLINE_FUNCTION T value() const { return volume > 0 ? sum / volume : T(0); }
};

/// Calls give(p, mean) for each of the particles [first, last) of a cell, with the mean over those of its
/// material. weighted(p): volume times value; not asked for again once p's mean was given.
template <class Space, class T, int Dim, class Weighted, class Give>
KOKKOS_INLINE_FUNCTION void average_by_material(const Soil<Space, T, Dim>& soil, int first, int last,
                                                const Weighted& weighted, const Give& give) {
  constexpr int k_none = 1 << 30;
  for (int material = -1;;) {  // those of the cell, in the order of their numbers
    int next = k_none;
    for (int p = first; p < last; ++p)
      if (const int of = soil.material_of(p); of > material) next = Kokkos::min(next, of);
    if (next == k_none) return;
    material = next;
    CellMean<T> mean;
    for (int p = first; p < last; ++p)
      if (soil.material_of(p) == material) mean.add(soil.volume(p), weighted(p));
    for (int p = first; p < last; ++p)
      if (soil.material_of(p) == material) give(p, mean.value());
  }
}

/// The dilatation rate [1/s] that the run's fraction of F-bar is of where a material takes only a share of
/// that fraction: advance() then gives a particle that share of its cell's mean, and the rest of its own.
template <class T>
KOKKOS_INLINE_FUNCTION T mean_for(T share, T mean, T own) {
  return share * mean + (1 - share) * own;
}

/// Brings the dilatations of the particles [first, last) of a cell together, as advance() does. mean: over
/// all of them; trace(p): a particle's own; dilate(p, to): moves it towards `to` by the fraction of F-bar.
template <class Space, class T, int Dim, class Trace, class Dilate>
KOKKOS_INLINE_FUNCTION void bring_together(const Soil<Space, T, Dim>& soil, int first, int last,
                                           bool by_material, const CellMean<T>& mean, const Trace& trace,
                                           const Dilate& dilate) {
  if (!by_material) {
    for (int p = first; p < last; ++p) dilate(p, mean.value());
    return;
  }
  average_by_material(
      soil, first, last, [&](int p) { return soil.volume(p) * trace(p); },
      [&](int p, T of_cell) {
        dilate(p, mean_for(soil.materials(soil.material_of(p)).f_bar_share, of_cell, trace(p)));
      });
}

}  // namespace mpm
