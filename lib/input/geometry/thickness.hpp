#pragma once
// How thick a body is whose surface is of triangles, or whose section is a polygon.

#include <optional>

#include "input/geometry/polygon.hpp"
#include "input/geometry/triangle_surface.hpp"

namespace mpm {

/// Thickness across a surface at a place of it [m].
struct Thickness {
  double value;
  Vec3 place;
};

/// Thickness [m] that a twentieth of a surface, or more of it, is below, with a place as thin; none where it
/// is `most` or more. Measured at points spread evenly over the surface, straight inwards, to a twelfth of
/// `most`: edges and tips count little.
std::optional<Thickness> thinnest_twentieth(const TriangleSurface& surface, double most);

/// Whether a twentieth of a polygon's edges in the mesh, or more, has another one, parallel to 30 degrees,
/// within `most` [m] behind it. Beyond the mesh, from `lower` to `upper`, a polygon goes on.
bool is_thin(const Polygon& polygon, const Point2& lower, const Point2& upper, double most);

}  // namespace mpm
