#pragma once
// The surface of triangles that contact measures from: its convex edges and corners are rounded.

#include "input/geometry/box_tree.hpp"
#include "input/geometry/triangle_distance.hpp"

namespace mpm {

/// Union of all balls of a radius in the body (an opening: Serra 1982), as boxes and polygons have it: at a
/// rounded edge the normal lies between those of its faces. The radius is less where the body is thin, or
/// where an edge would recede by more than it. Edges that point into the body stay sharp.
class RoundedSurface {
 public:
  /// Distance [m], positive outside, the way out of length 1 (zero where there is none), and whether an edge
  /// is nearest, rounded or not, where faces differ by 30 degrees.
  struct Distance {
    double value;
    Vec3 normal;
    bool at_edge;
  };

  /// radius [m]: of the balls.
  RoundedSurface(const TriangleDistance& sharp, double radius);

  /// guess: a triangle that may be near, or -1; it is set to the nearest one. walks: the guess leads there
  /// over a smooth surface (TriangleDistance::walked).
  Distance at(const Vec3& x, int& guess, bool walks = false) const;
  const TriangleDistance& sharp() const { return sharp_; }
  /// Whether the surface has an edge of more than 10 degrees, convex or not, in a box.
  bool bends_in(const Box& box) const;

 private:
  /// A plane that the centre of a ball must be behind by its radius.
  struct Plane {
    Vec3 normal, point;
  };
  using Planes = std::vector<Plane>;
  using Nearest = TriangleDistance::Nearest;

  bool is_near_edge(const Vec3& place) const;
  void add_planes(const Vec3& from, const Nearest& to, Planes& planes) const;
  Distance sharp_at(const Vec3& x, const Nearest& to) const;
  bool rounded_at(const Vec3& x, const Nearest& to, double radius, Distance& out, double& less) const;

  const TriangleDistance& sharp_;
  double radius_;
  BoxTree edges_;  // convex ones
  BoxTree bends_;  // all
};

}  // namespace mpm
