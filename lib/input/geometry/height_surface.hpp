#pragma once
// A surface by its height over the ground plane: a level, a polyline or a raster.

#include <optional>
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Heights at the crossings of lines of constant x and y. In 2D, and for a polyline in 3D, the height does
/// not depend on y. A cell of the lines has four triangles, which share the mean of its corners: the same
/// volume as the bilinear surface, and no direction is preferred.
class HeightSurface {
 public:
  /// A level [m].
  explicit HeightSurface(double level) : height_{level} {}
  /// heights[j * x.size() + i] at x[i], y[j] [m], which grow; NaN where there is none. Without y: heights[i].
  HeightSurface(std::vector<double> x, std::vector<double> y, std::vector<double> heights);

  bool is_level() const { return x_.empty(); }
  /// The lines along an axis, x or y [m]; none where the height does not depend on it.
  const std::vector<double>& lines(int d) const { return d == 0 ? x_ : y_; }
  double node(std::size_t i, std::size_t j) const { return height_[j * x_.size() + i]; }
  /// Height [m] at a point; beyond the lines that of the nearest place on them.
  double at(double x, double y) const;
  /// First and last line around a part of an axis; {0, 0} where there are none.
  std::array<std::size_t, 2> lines_around(int d, double low, double high) const;

 private:
  std::vector<double> x_, y_;   // m
  std::vector<double> height_;  // m
};

/// Bounds of what is between two surfaces in the mesh; of rasters of the same cells, only where they are
/// apart.
struct LayerBounds {
  Vec3 lower{}, upper{};  // m
};
LayerBounds bounds_between(const HeightSurface& top, const HeightSurface& base, const MeshConfig& mesh,
                           int dim);

/// Lowest and highest height in the mesh [m].
std::array<double, 2> heights_of(const HeightSurface& surface, const MeshConfig& mesh, int dim);

/// Fault of a surface for a mesh, as the end of "takes ...". A sound surface covers the mesh as seen from
/// above, has a height everywhere there, and is in the mesh. Empty where all is well.
std::string fault_of(const HeightSurface& surface, const MeshConfig& mesh, int dim);

/// The place in the mesh where the surface `base` is furthest above `top`; none where it nowhere is by more
/// than round-off.
struct Crossing {
  double x, y, height;  // m
};
std::optional<Crossing> crossing_of(const HeightSurface& top, const HeightSurface& base,
                                    const MeshConfig& mesh, int dim);

}  // namespace mpm
