#pragma once
// A union of shapes, the parts of a rigid body.

#include "input/geometry/mass_properties.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {

/// Volume of a union in the mesh [m3; m2 in 2D]: that of its parts, less what several share. The latter by
/// points: exact where two boxes along the axes overlap, right to some thousandths of itself elsewhere.
double united_volume(const Shape& shape, const MeshConfig& mesh, int dim);

/// Mass properties of a whole union, likewise. All parts have some of their own.
MassProperties united_properties(const Shape& shape, int dim);

/// Bounds of a union.
Bounds united_bounds(const Shape& shape, const MeshConfig& mesh, int dim);

/// The parts, with boxes and cylinders made longer where an end lies wholly in or on other parts, by two
/// cells at most: the union is the same, and no end of a part is near its surface.
std::vector<Shape> grown_parts(const Shape& shape, const MeshConfig& mesh, int dim);

}  // namespace mpm
