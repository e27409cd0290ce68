#include "input/region.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {
namespace {

/// The coordinates of a polygon's plane: x and the vertical one.
Point2 in_plane(const Vec3& x, int dim) { return {x[0], x[dim - 1]}; }

}  // namespace

Vec3 turned(const Vec3& x, const Vec3& about, double angle, int dim) {
  if (angle == 0) return x;
  const int up = dim - 1;
  const double c = std::cos(angle), s = std::sin(angle), a = x[0] - about[0], b = x[up] - about[up];
  Vec3 y = x;
  y[0] = about[0] + c * a - s * b;
  y[up] = about[up] + s * a + c * b;
  return y;
}

void Region::enter_row(double low, double high) {
  if (shape_.kind == ShapeKind::polygon) edges_ = edges_in_row(shape_.polygon, low - slack_, high + slack_);
}

bool Region::box_holds(const Vec3& x) const {
  const Vec3 in = turned(x, shape_.lower, -shape_.angle, dim_);
  double square = 0;  // of the distance to the box made smaller by its fillet
  for (int d = 0; d < dim_; ++d) {
    const double out =
        std::max({shape_.lower[d] + shape_.fillet - in[d], in[d] - shape_.upper[d] + shape_.fillet, 0.0});
    square += out * out;
  }
  return square <= (shape_.fillet + slack_) * (shape_.fillet + slack_);
}

bool Region::prism_holds(const Vec3& x) const {
  if (dim_ == 3 && (x[1] < shape_.width[0] - slack_ || x[1] > shape_.width[1] + slack_)) return false;
  return is_inside(edges_, in_plane(x, dim_), slack_);
}

bool Region::holds(const Vec3& x) const {
  double square = 0, beyond = 0;  // of the distance to the centre; distance beyond the face
  for (int d = 0; d < dim_; ++d) {
    square += (x[d] - shape_.centre[d]) * (x[d] - shape_.centre[d]);
    beyond += (x[d] - shape_.point[d]) * shape_.normal[d];
  }
  switch (shape_.kind) {
    case ShapeKind::box: return box_holds(x);
    case ShapeKind::polygon: return prism_holds(x);
    case ShapeKind::disc: return square <= (shape_.radius + slack_) * (shape_.radius + slack_);
    case ShapeKind::half_plane: return beyond <= slack_;
    default: return false;  // a list of particles has no inside
  }
}

bool Region::holds_cell(const Vec3& corner, double edge) const {
  for (int k = 0; k < 1 << dim_; ++k) {
    Vec3 x = corner;
    for (int d = 0; d < dim_; ++d) x[d] += (k >> d & 1) * edge;
    if (!holds(x)) return false;
  }
  // The corners suffice for all shapes but polygons, since they are convex.
  const Point2 lower = in_plane(corner, dim_), upper{lower[0] + edge, lower[1] + edge};
  return std::none_of(edges_.begin(), edges_.end(),
                      [&](const Edge& side) { return enters_square(side, lower, upper, slack_); });
}

}  // namespace mpm
