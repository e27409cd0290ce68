#pragma once
// Shapes of the ground: closed surfaces of triangles, and layers between two surfaces.

#include "input/options/reader.hpp"

namespace mpm {

/// -NAME_file and -NAME_scale of an STL surface.
void read_stl_shape(OptionReader& in, const std::string& name, Shape& shape);

/// -NAME_top and -NAME_base of a layer: a level, a polyline, a raster, or the name of one of the bodies that
/// were read before, whose surface it shares. Whether both are there; a mistake of the other body is reported
/// with that body alone.
bool read_layer(OptionReader& in, const std::string& name, const Config& config, Shape& shape);

/// Checks the surfaces of a layer against the mesh and against each other. Whether they are sound.
bool check_layer(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                 int dim);

}  // namespace mpm
