#pragma once
// Signed distance to a closed surface of triangles.

#include <memory>

#include "input/geometry/triangle_surface.hpp"

namespace mpm {

/// A plane that reflects a surface: that across direction d at a place [m]. What is seen beyond it is the
/// image of what is before it.
struct Mirror {
  int d;
  bool upper;  // the surface is below it
  double place;
};

/// Exact distance to the triangles of a surface, whose inside is where the angle-weighted pseudo-normal of
/// the nearest feature points away from (Baerentzen & Aanaes 2005). Triangles that lie on a mirror are none:
/// there the surface goes on as its image.
class TriangleDistance {
 public:
  /// Part of a triangle: its face, or by number an edge (from that corner to the next) or a corner.
  enum class Feature : char { face, edge, corner };
  struct Nearest {
    double value = 0;   // m, positive outside
    Vec3 point{};       // m, on the surface
    Vec3 normal{};      // of length 1, out of the surface: of the face, or the pseudo-normal
    int triangle = -1;  // -1: there is none within the limit
    Feature feature = Feature::face;
    int part = 0;         // edge or corner of the triangle
    bool images[3] = {};  // directions in which it is the image of the triangle
  };

  TriangleDistance(std::shared_ptr<const TriangleSurface> surface, std::vector<Mirror> mirrors);

  /// The nearest place of the surface to x [m], if it is nearer than `limit` [m]. guess: a triangle that may
  /// be near, or -1; it changes the time alone.
  Nearest nearest(const Vec3& x, int guess = -1, double limit = 1e150) const;
  /// The nearest place that is found by steps from a triangle to those that share the edge or corner that is
  /// the nearest there. Where the surface between is smooth it is the nearest of all, in a fraction of the
  /// time.
  Nearest walked(const Vec3& x, int from) const;

  const TriangleSurface& surface() const { return *surface_; }
  const std::vector<Mirror>& mirrors() const { return mirrors_; }
  /// Normal of a triangle, of length 1.
  const Vec3& normal(int k) const { return normals_[k]; }
  /// The triangle beyond edge c of triangle k; -1: an image.
  int beyond(int k, int c) const { return beyond_[3 * k + c]; }
  /// Whether the triangle lies on a mirror.
  bool is_left_out(int k) const { return left_out_[k]; }
  /// Triangles at a vertex.
  std::vector<int> round(int vertex) const;
  /// Leaves of a vector at a place what its images do not cancel.
  Vec3 with_images(const Vec3& at, Vec3 v) const;

 private:
  void set_neighbours();
  void set_corners();
  Vec3 pseudo_normal(const Nearest& of) const;
  bool approach(const Vec3& x, int k, double& least, Nearest& out) const;
  Vec3 before_mirrors(const Vec3& at, Nearest& out) const;
  void finish(const Vec3& at, const Vec3& x, double least, Nearest& out) const;

  std::shared_ptr<const TriangleSurface> surface_;
  std::vector<Mirror> mirrors_;
  double slack_;               // m, nearer to a mirror is on it
  std::vector<Vec3> normals_;  // of triangles
  std::vector<Vec3> corners_;  // pseudo-normals of vertices
  std::vector<int> beyond_;    // [3 a triangle]
  std::vector<char> left_out_;
  std::vector<int> first_, list_;  // triangles at each vertex
};

}  // namespace mpm
