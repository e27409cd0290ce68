#pragma once
// Cylinders and cones with a vertical axis, in 3D.

#include "input/geometry/polygon.hpp"
#include "mpm/config.hpp"

namespace mpm {

inline bool is_revolved(const Shape& shape) {
  return shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone;
}

/// Lowest and highest z [m].
std::array<double, 2> ends_of(const Shape& shape);

/// The section through the axis, a convex polygon, anticlockwise [m]: distance from the axis, negative on the
/// other side of it, and z. Flat ends go on as a cylinder by `below` and `above` [m].
Polygon section_of(const Shape& shape, double below, double above);

/// Whether x [m] is inside, or within `slack` [m] of the surface.
bool revolved_holds(const Shape& shape, const Vec3& x, double slack);

}  // namespace mpm
