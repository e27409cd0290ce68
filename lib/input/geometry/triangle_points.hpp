#pragma once
// Points of a surface of triangles.

#include <memory>
#include <vector>

#include "input/geometry/triangle_surface.hpp"

namespace mpm {

/// A point of a surface [m], the normal there, out of the surface, of length 1, and the radius of a ball that
/// touches the surface there from inside [m]: 0 at edges and corners.
struct TrianglePoint {
  Vec3 x, normal;
  double radius = 0;
};

/// Vertices of a surface, the sharpest first, points of its edges that point outwards and, with `faces`, of
/// its faces, `apart` [m] from each other at most. Those of small triangles are left out: no two are nearer
/// than half of that. Balls may come out of the surface by a fiftieth of `apart`, so that those of a ball of
/// triangles are almost the whole ball; there is none of a radius below `apart`/2.
std::vector<TrianglePoint> triangle_points(const std::shared_ptr<const TriangleSurface>& surface,
                                           double apart, bool faces);

}  // namespace mpm
