#pragma once
// Forces of the soil on the sides of the mesh.

#include <array>

#include "data/core.hpp"
#include "data/surface_loads.hpp"

namespace mpm {

/// Force of the soil [N] on each side of the mesh, [direction][lower or upper], as its stress and weight are
/// now, in water in excess of the hydrostatic pressure; on a roller the part normal to it, on a free side
/// none. Loads on surfaces count. Only from the soil of this rank.
using WallForces = std::array<std::array<std::array<double, 3>, 2>, 3>;
template <class Space, class T, int Dim>
WallForces wall_forces(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads);

}  // namespace mpm
