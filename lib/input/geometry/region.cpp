#include "input/geometry/region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "input/geometry/height_surface.hpp"
#include "input/geometry/revolved.hpp"
#include "input/geometry/triangle_surface.hpp"

namespace mpm {
namespace {

constexpr double k_everywhere = std::numeric_limits<double>::infinity();

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

Region::Region(const Shape& shape, int dim, double slack)
    : shape_(shape), dim_(dim), slack_(slack), low_(k_everywhere), high_(-k_everywhere) {
  if (shape.kind == ShapeKind::polygon) tree_.emplace(shape.polygon);
  for (const Shape& part : shape.parts) parts_.emplace_back(part, dim, slack);
}

void Region::enter_row(double low, double high) {
  if (low == low_ && high == high_) return;
  low_ = low, high_ = high;
  for (Region& part : parts_) part.enter_row(low, high);
  edges_.clear();
  if (tree_)
    tree_->in_row(low - slack_, high + slack_, [&](int k) { edges_.push_back(edge_of(shape_.polygon, k)); });
}

Region::Span Region::span_of_edges() const {
  Span span{k_everywhere, -k_everywhere};
  for (const Edge& edge : edges_)
    for (const Point2& end : {edge.from, edge.to})
      span = {std::min(span.from, end[0] - 2 * slack_), std::max(span.to, end[0] + 2 * slack_)};
  return span;
}

Region::Span Region::span_of_disc(double low, double high) const {
  const auto off = [](double centre, double from, double to) {
    return std::max({from - centre, centre - to, 0.0});
  };
  double square = std::pow(shape_.radius + 2 * slack_, 2);  // round-off is less than the slack
  const bool ball = shape_.kind == ShapeKind::disc;
  if (ball) square -= std::pow(off(shape_.centre[dim_ - 1], low_, high_), 2);
  if (dim_ == 3) square -= std::pow(off(shape_.centre[1], low, high), 2);
  if (square < 0) return {k_everywhere, -k_everywhere};
  return {shape_.centre[0] - std::sqrt(square), shape_.centre[0] + std::sqrt(square)};
}

/// Finds the span by the row's point that is furthest behind the face.
Region::Span Region::span_behind(double low, double high) const {
  const Vec3 &n = shape_.normal, &point = shape_.point;
  const auto least = [](double slope, double from, double to) { return std::min(slope * from, slope * to); };
  double left = 2 * slack_ - least(n[dim_ - 1], low_ - point[dim_ - 1], high_ - point[dim_ - 1]);
  if (dim_ == 3) left -= least(n[1], low - point[1], high - point[1]);
  if (n[0] == 0) return left < 0 ? Span{k_everywhere, -k_everywhere} : Span{-k_everywhere, k_everywhere};
  const double x = point[0] + left / n[0];
  return n[0] > 0 ? Span{-k_everywhere, x} : Span{x, k_everywhere};
}

Region::Span Region::span_of_parts(double low, double high) const {
  Span all{k_everywhere, -k_everywhere};
  for (const Region& part : parts_) {
    const Span span = part.span(low, high);
    if (span.from <= span.to) all = {std::min(all.from, span.from), std::max(all.to, span.to)};
  }
  return all;
}

Region::Span Region::span(double low, double high) const {
  switch (shape_.kind) {
    case ShapeKind::polygon: return span_of_edges();
    case ShapeKind::disc:
    case ShapeKind::cylinder:
    case ShapeKind::cone: return span_of_disc(low, high);
    case ShapeKind::half_plane: return span_behind(low, high);
    case ShapeKind::parts: return span_of_parts(low, high);
    default: return {-k_everywhere, k_everywhere};  // a box: its own lattice has no other sites
  }
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

bool Region::layer_holds(const Vec3& x) const {
  const double y = dim_ == 3 ? x[1] : 0, height = x[dim_ - 1];
  return height <= shape_.top->at(x[0], y) + slack_ && height >= shape_.base->at(x[0], y) - slack_;
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
    case ShapeKind::cylinder:
    case ShapeKind::cone: return revolved_holds(shape_, x, slack_);
    case ShapeKind::half_plane: return beyond <= slack_;
    case ShapeKind::stl: return shape_.triangles->holds(x, slack_);
    case ShapeKind::layer: return layer_holds(x);
    case ShapeKind::parts:
      return std::any_of(parts_.begin(), parts_.end(), [&](const Region& part) { return part.holds(x); });
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
