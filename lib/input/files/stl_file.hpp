#pragma once
#include <memory>
#include <string>

#include "input/geometry/triangle_surface.hpp"

namespace mpm {

/// Reads a closed surface from an STL file, ASCII or binary, or an OBJ file, which ends in .obj, with all
/// lengths times `scale`, and then moved by `offset` [m]. Returns what the file should have been, as the end
/// of "takes ..."; empty where all is well. The normals of the file are passed over: the order of the corners
/// defines the outside.
std::string read_stl(const std::string& path, double scale, std::shared_ptr<const TriangleSurface>& surface,
                     const Vec3& offset = {});

}  // namespace mpm
