#pragma once
// Bodies of revolution (-geometry axisymmetric).

#include <numbers>

#include "mpm/config.hpp"

namespace mpm {

/// Length of the circle that a point at this radius [m] is revolved along, m; 1 where the run is not
/// axisymmetric. Times the area of a particle's section it is the particle's volume (Pappus).
inline double revolved_length(const Config& config, double radius) {
  return config.geometry == Geometry::axisymmetric ? 2 * std::numbers::pi * radius : 1;
}

}  // namespace mpm
