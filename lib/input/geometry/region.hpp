#pragma once
// Test whether a point is inside a shape. "Inside" includes the boundary, with a slack, so that round-off
// never decides.

#include <optional>
#include <vector>

#include "input/geometry/edge_tree.hpp"
#include "input/geometry/polygon.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// A point [m] turned by an angle [rad] about the point `about`, from the x axis to the vertical one: y in
/// 2D; in 3D z, so that it turns about the y axis.
Vec3 turned(const Vec3& x, const Vec3& about, double angle, int dim);

/// The inside of a shape, which must outlive it, asked row by row (of constant height).
class Region {
 public:
  /// `slack` [m] is what a point may be outside.
  Region(const Shape& shape, int dim, double slack);

  /// Prepares for points and cells whose vertical coordinate is from low to high [m].
  void enter_row(double low, double high);
  bool holds(const Vec3& x) const;
  /// Whether all of a cell is inside.
  bool holds_cell(const Vec3& corner, double edge) const;

  /// From where to where in x [m] a row may hold something.
  struct Span {
    double from, to;
  };
  /// That of the row entered, and in 3D of y from `low` to `high` [m].
  Span span(double low, double high) const;

 private:
  bool box_holds(const Vec3& x) const;
  bool prism_holds(const Vec3& x) const;
  bool layer_holds(const Vec3& x) const;
  Span span_of_edges() const;
  Span span_of_disc(double low, double high) const;
  Span span_behind(double low, double high) const;
  Span span_of_parts(double low, double high) const;

  const Shape& shape_;
  std::vector<Region> parts_;
  int dim_;
  double slack_;
  std::optional<EdgeTree> tree_;  // polygon: of its edges
  double low_, high_;             // m, the row
  std::vector<Edge> edges_;       // polygon: those of the row
};

}  // namespace mpm
