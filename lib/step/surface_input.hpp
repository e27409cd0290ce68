#pragma once
// A rigid body's shape as the surface that contact kernels measure from.

#include "mpm/config.hpp"
#include "transfer/upload.hpp"

namespace mpm {

/// How the corners of a surface are: `rounded` by half a cell's edge at least, so that the normal at a corner
/// lies between those of its faces, or as `sharp` as those of the shape.
enum class Corners { rounded, sharp };

/// The surface of a shape. A face on the mesh's boundary is none: no soil can be behind it, so the body goes
/// on beyond the mesh. That of an stl with sharp corners has no samples: the rounded one has them.
SurfaceInput surface_input(const Shape& shape, const MeshConfig& mesh, int dim,
                           Corners corners = Corners::rounded);

}  // namespace mpm
