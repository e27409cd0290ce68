#pragma once
// Points of the surfaces of rigid bodies, where other bodies may touch them.

#include "mpm/config.hpp"
#include "transfer/upload_pairs.hpp"

namespace mpm {

inline constexpr double k_flush = 1e-3;  // cells: nearer to a side of the mesh a body is on it

/// Points of a shape's surface in the mesh: of corners and edges, and with `faces` of faces too, half a cell
/// apart at most; the centre of a ball. Points of parts of a union that others cover are none.
SurfacePoints surface_points(const Config& config, const Shape& shape, bool faces);

}  // namespace mpm
