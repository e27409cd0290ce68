#pragma once
#include "mpm/config.hpp"

namespace mpm {

/// Whether frames and probes have a pore pressure, and total stress.
inline bool has_pore_pressure(const Config& config) {
  for (const MaterialConfig& material : config.materials)
    if (material.has_pore_pressure()) return true;
  return config.water.level.has_value();
}

}  // namespace mpm
