#pragma once
// Space that a body or rigid occupies at the start: its shape without the parts that are cut out, or the
// places of the particles that a file lists.

#include <unordered_map>
#include <vector>

#include "input/geometry/region.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {

/// Particles by the square (cube) of their width that they are in.
class PlacesOfParticles {
 public:
  PlacesOfParticles(std::vector<double> position, double width, int dim);
  /// Whether a point is within half a width of a particle, in each direction.
  bool hold(const Vec3& x) const;
  const Bounds& bounds() const { return bounds_; }

 private:
  long cell_of(double x, int d) const;
  std::size_t key_of(const std::array<long, 3>& cell) const;

  std::vector<double> position_;  // m, packed by dim
  double width_;                  // m
  int dim_;
  Bounds bounds_;
  std::unordered_multimap<std::size_t, std::size_t> particles_;  // first component in position_ by cell
};

/// A body or rigid.
class Filled {
 public:
  /// `shape` must outlive it; `cut_out` are shapes that it has no particles in.
  Filled(const Shape& shape, const std::vector<Shape>& cut_out, const MeshConfig& mesh, int dim);
  /// Makes the space of soil from the places of its particles [m, packed by dim]: those of a file, or, where
  /// it has moved, of the run.
  Filled(const Shape& shape, std::vector<double> position, bool has_moved, const std::vector<Shape>& cut_out,
         const MeshConfig& mesh, int dim);

  /// Moves all of it by a displacement [m].
  void move(const Vec3& by);
  /// Prepares for points whose vertical coordinate is from low to high [m].
  void enter_row(double low, double high);
  bool holds(const Vec3& x) const;

  Bounds bounds;
  double volume = 0;    // m3 (m2 in 2D), with what is cut out
  double width = 0;     // m, of its particles
  bool listed = false;  // by a file
  double thinnest = 0;  // m, the least extent of its bounds

 private:
  void measure();
  bool soil_holds(const Vec3& x) const;

  const Shape& shape_;
  MeshConfig mesh_;
  int dim_;
  std::vector<Shape> cut_shapes_;
  std::vector<Region> region_, holes_;  // none or one; any number
  std::vector<PlacesOfParticles> places_;
  bool has_moved_ = false;  // its particles are no lattice any more
  Vec3 moved_{};            // m
};

}  // namespace mpm
