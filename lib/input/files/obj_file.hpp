#pragma once
// Wavefront OBJ files.

#include <string>
#include <string_view>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Reads the corners of triangles, one after the other, from the lines `v` and `f` of an OBJ file, with all
/// lengths times `scale`. A face of more corners becomes a fan of triangles. Returns what the file should
/// have been, as the end of "takes ..."; empty where all is well.
std::string read_obj(std::string_view text, double scale, std::vector<Vec3>& corners);

}  // namespace mpm
