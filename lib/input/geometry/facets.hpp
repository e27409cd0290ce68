#pragma once
// The surface of a shape as plane pieces, for the volumes of what it cuts.

#include <memory>
#include <vector>

#include "input/geometry/convex_piece.hpp"
#include "input/geometry/height_surface.hpp"
#include "input/geometry/triangle_surface.hpp"

namespace mpm {

/// Whether facets_of() can make the surface of a shape.
bool has_facets(const Shape& shape);

/// Pieces, anticlockwise as seen from outside: from above, an upper side has a positive area and a lower one
/// a negative area. Pieces that are vertical may be missing. In 2D the shape is one that goes on from y = 0
/// to 1, and its heights are the third coordinate.
class Facets {
 public:
  /// Facets of a shape that has them. Curved shapes have so many facets that each is about as wide as `width`
  /// [m], at least 64 around, and the radius that gives their volume.
  Facets(const Shape& shape, const MeshConfig& mesh, int dim, double width);

  std::size_t size() const { return flats_.size() + triangles() + rasters_[0].count + rasters_[1].count; }
  ConvexPiece operator[](std::size_t k) const;
  /// Volume [m3] (area [m2] in 2D) in the mesh.
  double volume() const;

 private:
  /// The triangles of a raster that are over the mesh, in place of a list of them: four in a cell.
  struct Raster {
    const HeightSurface* surface = nullptr;
    std::size_t first[2]{}, cells[2]{}, count = 0;
    bool upper = true;
    ConvexPiece operator[](std::size_t k) const;
  };

  /// A triangle or a quadrilateral.
  struct Flat {
    int count;
    Vec3 x[4];
  };
  void add(const Vec3& a, const Vec3& b, const Vec3& c);
  void add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
  void add_surface(const HeightSurface& surface, bool upper);
  void add_outline(const std::vector<std::array<double, 2>>& outline, double from, double to);
  void add_revolved(const std::vector<std::array<double, 2>>& side, const Vec3& centre, double width);

  MeshConfig mesh_;
  int dim_;
  std::size_t triangles() const { return surface_ ? static_cast<std::size_t>(surface_->size()) : 0; }

  std::vector<Flat> flats_;
  const TriangleSurface* surface_ = nullptr;
  Raster rasters_[2];
};

}  // namespace mpm
