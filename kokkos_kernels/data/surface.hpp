#pragma once
// The surface of a rigid body.

#include "base/types.hpp"

namespace mpm {

enum class SurfaceKind : int { box, polygon, disc, half_plane, revolved, heights, sampled, parts };

/// A vertex of a polygon in the plane of x and the vertical axis [m from the mesh's lower corner], and
/// whether the edge that begins there lies on the mesh's boundary, where no soil can be behind it. For a
/// revolved body, a vertex of its section: distance from the axis and height above the centre. For a surface
/// of heights, z is one of them.
struct Vertex {
  double x, z;
  bool outside;
};

/// The surface of a body at the start. Lengths in m from the mesh's lower corner.
template <int Dim>
struct Surface {
  SurfaceKind kind;
  Vector<double, Dim> centre;  // box, disc; half_plane: a point on it; revolved: of the vertices' heights
  Vector<double, Dim> half;    // box: half its edges; polygon in 3D: half[1] is half the prism's width
  Vector<double, Dim> normal;  // half_plane: outward, of length 1
  double radius;               // disc; box, polygon, revolved: of its corners
  double cosine, sine;         // box: of the angle that turns x to the vertical axis
  int first, count;  // polygon; revolved: vertices of it or of its section, made smaller by the radius;
                     // heights: on a grid of squares of edge `radius` from `centre` on, x fastest;
                     // sampled: number of the grid of its samples; parts: surfaces of them
  int columns;       // heights: in a row
  double round_off;  // m, of places: less has no direction
};

}  // namespace mpm
