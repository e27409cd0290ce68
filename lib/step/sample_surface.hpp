#pragma once
// Samples of the distance to a surface of triangles, for contact kernels.

#include "mpm/config.hpp"
#include "transfer/upload.hpp"

namespace mpm {

/// Samples the surface of an stl, whose convex edges are rounded by half a cell of the mesh. Where triangles
/// lie on a side of the mesh, the surface goes on as its image beyond it.
SurfaceInput sampled_surface(const Shape& shape, const MeshConfig& mesh);

/// Bytes of the samples of a shape and its parts: about as many, and 0 of a shape that is no stl.
double sample_bytes(const Shape& shape, const MeshConfig& mesh);

}  // namespace mpm
