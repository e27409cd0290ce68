#pragma once
// A closed surface of triangles, as an STL file has it.

#include <array>
#include <string>
#include <vector>

#include "input/geometry/box_tree.hpp"
#include "input/geometry/plan_bins.hpp"

namespace mpm {

/// Triangles whose corners are anticlockwise as seen from outside. Vertices at one place are one vertex.
class TriangleSurface {
 public:
  /// Builds from the corners of triangles, one after the other [m]. Leaves out triangles with two corners at
  /// one place.
  explicit TriangleSurface(const std::vector<Vec3>& corners);

  int vertices() const { return static_cast<int>(vertices_.size()); }
  int size() const { return static_cast<int>(triangles_.size()); }
  const std::array<int, 3>& triangle(int k) const { return triangles_[k]; }
  const Vec3& vertex(int v) const { return vertices_[v]; }
  Vec3 corner(int k, int c) const { return vertices_[triangles_[k][c]]; }
  const BoxTree& tree() const { return tree_; }
  const Box& bounds() const { return bounds_; }

  /// Enclosed volume [m3], by the divergence theorem; less than 0 if the triangles face inwards.
  double volume() const { return volume_; }
  double area() const { return area_; }  // m2
  /// Whether a point is inside, or below or above the inside by less than `slack` [m]: a vertical line
  /// upwards from it leaves more often than it enters. The point counts as moved by an infinitely small
  /// length along x, and by one smaller still along y, so that no line meets an edge.
  bool holds(const Vec3& x, double slack) const;

 private:
  std::vector<Vec3> vertices_;  // m
  std::vector<std::array<int, 3>> triangles_;
  BoxTree tree_;
  PlanBins bins_;
  Box bounds_;
  double volume_ = 0, area_ = 0;
};

/// Fault of a surface, as the end of "takes ..."; empty where it is closed, faces outwards, and
/// neither crosses nor touches itself. In n log n.
std::string fault_of(const TriangleSurface& surface);

}  // namespace mpm
