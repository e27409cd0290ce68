#pragma once
// Hydrostatic water, in which soil is submerged.

#include "base/types.hpp"

namespace mpm {

/// A part of the mesh where the water has a level of its own.
template <int Dim>
struct WaterRegion {
  Vector<double, Dim> lower{}, upper{};  // m
  double level = 0;                      // m
};
inline constexpr int k_most_water_regions = 4;

/// Hydrostatic water. Lengths are from the mesh's lower corner.
template <int Dim>
struct Water {
  double density = 0;  // kg/m3; 0: there is none
  double level = 0;    // m, height of the level against gravity
  int region_count = 0;
  WaterRegion<Dim> regions[k_most_water_regions]{};  // where they overlap, the last one counts
  Vector<double, Dim> down{};                        // -, unit vector of gravity
  double gravity = 0;                                // m/s2, its size

  KOKKOS_INLINE_FUNCTION bool is_there() const { return density > 0; }
  /// Height of the level [m] where a point is.
  KOKKOS_INLINE_FUNCTION double level_at(const Vector<double, Dim>& x) const {
    double height = level;
    for (int r = 0; r < region_count; ++r) {
      bool inside = true;
      for (int d = 0; d < Dim; ++d)
        inside = inside && x[d] >= regions[r].lower[d] && x[d] <= regions[r].upper[d];
      if (inside) height = regions[r].level;
    }
    return height;
  }
  /// Depth of a point below the level [m]; negative above it.
  KOKKOS_INLINE_FUNCTION double depth(const Vector<double, Dim>& x) const {
    double depth = level_at(x);
    for (int d = 0; d < Dim; ++d) depth += x[d] * down[d];
    return depth;
  }
  /// Hydrostatic pressure u_h [Pa] at a point.
  KOKKOS_INLINE_FUNCTION double pressure(const Vector<double, Dim>& x) const {
    return density * gravity * Kokkos::fmax(0.0, depth(x));
  }
  /// From the centre of a box of these half lengths [m] to its lowest point [m].
  KOKKOS_INLINE_FUNCTION double reach(const Vector<double, Dim>& half_length) const {
    double reach = 0;
    for (int d = 0; d < Dim; ++d) reach += half_length[d] * Kokkos::fabs(down[d]);
    return reach;
  }
  /// Share of a particle of these half lengths [m] that is below the level, its centre at x: exact where
  /// gravity is along an axis.
  KOKKOS_INLINE_FUNCTION double submerged_share(const Vector<double, Dim>& x,
                                                const Vector<double, Dim>& half_length) const {
    const double reach = this->reach(half_length);
    return Kokkos::fmin(1.0, Kokkos::fmax(0.0, (depth(x) / reach + 1) / 2));
  }
};

/// Mass of the water that particles displace at a node [kg]; what it weighs carries the soil.
struct DisplacedTerms {
  static constexpr int mass = 0, size = 1;
};

}  // namespace mpm
