#pragma once
// Volumes of what is round.

#include "mpm/config.hpp"

namespace mpm {

/// Volume [m3] (area [m2] in 2D) of the part of a disc, ball, cylinder or cone that lies in the mesh. Its
/// centre, or its axis, is not beyond a side of the mesh.
double round_volume(const Shape& shape, const MeshConfig& mesh, int dim);

}  // namespace mpm
