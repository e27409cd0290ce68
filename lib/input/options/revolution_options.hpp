#pragma once
// Bodies of revolution: -geometry axisymmetric.

#include "input/options/reader.hpp"

namespace mpm {

/// -geometry.
void read_geometry_of(OptionReader& in, Config& config);
/// Checks mesh, gravity and particles where the geometry is axisymmetric. After all of them.
void check_revolution(OptionReader& in, const Config& config);

}  // namespace mpm
