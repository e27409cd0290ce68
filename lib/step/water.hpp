#pragma once
// The water of a configuration, as kernels and output take it.

#include <cmath>

#include "common/gravity_on_soil.hpp"
#include "common/pore_pressure.hpp"
#include "data/water.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Hydrostatic water, by lengths from the mesh's lower corner.
template <int Dim>
Water<Dim> water_of(const Config& config) {
  Water<Dim> water;
  if (!config.water.level) return water;
  water.density = config.water.density, water.level = *config.water.level;
  water.gravity = std::hypot(config.gravity[0], config.gravity[1], config.gravity[2]);
  for (int d = 0; d < Dim; ++d) {
    water.down[d] = config.gravity[d] / water.gravity;
    water.level += config.mesh.lower[d] * water.down[d];
  }
  for (const WaterRegionConfig& region : config.water.regions) {
    if (!region.dry && !region.level) continue;
    WaterRegion<Dim>& own = water.regions[water.region_count++];
    constexpr double k_dry = -1e12;  // m
    own.level = region.dry ? k_dry : *region.level + (water.level - *config.water.level);
    for (int d = 0; d < Dim; ++d) {
      own.lower[d] = region.lower[d] - config.mesh.lower[d];
      own.upper[d] = region.upper[d] - config.mesh.lower[d];
    }
  }
  return water;
}

/// The water of the kernels: none where it carries all soil alike (gravity_on_soil).
template <int Dim>
Water<Dim> water_of_kernels(const Config& config) {
  return carries_alike(config) ? Water<Dim>{} : water_of<Dim>(config);
}

}  // namespace mpm
