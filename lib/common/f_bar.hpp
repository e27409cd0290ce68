#pragma once
// Fractions of F-bar: the run has one, and a material may have its own.

#include <algorithm>

#include "mpm/config.hpp"

namespace mpm {

/// Fraction of the cell's mean in the dilatation of particles of a material [-].
inline double f_bar_fraction(const Config& config, const MaterialConfig& material) {
  return material.f_bar_fraction.value_or(config.f_bar_fraction);
}

/// The least and the largest fraction of the materials that bodies are of; of the run where there are none.
struct FBarRange {
  double least, largest;
};
inline FBarRange f_bar_range(const Config& config) {
  FBarRange range{config.f_bar_fraction, config.f_bar_fraction};
  for (const BodyConfig& body : config.bodies) {
    if (body.material >= static_cast<int>(config.materials.size())) continue;  // reported
    const double fraction = f_bar_fraction(config, config.materials[body.material]);
    const bool first = &body == &config.bodies.front();
    range = {first ? fraction : std::min(range.least, fraction),
             first ? fraction : std::max(range.largest, fraction)};
  }
  return range;
}

}  // namespace mpm
