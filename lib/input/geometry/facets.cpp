#include "input/geometry/facets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "input/geometry/polygon.hpp"
#include "input/geometry/revolved.hpp"

namespace mpm {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr double k_most_around = 1024;  // facets

/// Facets around a circle, a multiple of 4.
int around(double radius, double width) {
  return 4 * static_cast<int>(std::ceil(std::clamp(2 * k_pi * radius / width, 64.0, k_most_around) / 4));
}

/// Twice the area of a polygon, positive where it is anticlockwise.
double twice_area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    twice += a[0] * b[1] - b[0] * a[1];
  }
  return twice;
}

/// A regular polygon with the area of a disc.
Polygon disc_outline(const Shape& shape, double width) {
  const int count = around(shape.radius, width);
  const double step = 2 * k_pi / count, radius = shape.radius * std::sqrt(step / std::sin(step));
  Polygon outline;
  for (int k = 0; k < count; ++k)
    outline.push_back({shape.centre[0] + radius * std::cos((k + 0.5) * step),
                       shape.centre[1] + radius * std::sin((k + 0.5) * step)});
  return outline;
}

/// The side of a ball from its lower to its upper end, about its centre: the distances from the axis are
/// those that give the ball's volume as the frusta turn about it.
Polygon ball_side(double radius, double width) {
  const int count = around(radius, width) / 2;
  Polygon side;
  double volume = 0;
  for (int k = 0; k <= count; ++k) {
    const double angle = k_pi * k / count;
    side.push_back({k == 0 || k == count ? 0 : radius * std::sin(angle), -radius * std::cos(angle)});
    if (k == 0) continue;
    const auto [r, z] = side[k - 1];
    const auto [s, y] = side[k];
    volume += k_pi / 3 * (y - z) * (r * r + r * s + s * s);
  }
  const double grown = std::sqrt(4 * k_pi / 3 * std::pow(radius, 3) / volume);
  for (Point2& point : side) point[0] *= grown;
  return side;
}

/// The outer half of the section of a cylinder or cone, from its lower to its upper end.
Polygon revolved_side(const Shape& shape) {
  Polygon side;
  for (const Point2& point : section_of(shape, 0, 0))
    if (point[0] >= 0) side.push_back(point);
  return side;
}

}  // namespace

bool has_facets(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::polygon:
    case ShapeKind::disc:
    case ShapeKind::cylinder:
    case ShapeKind::cone:
    case ShapeKind::stl:
    case ShapeKind::layer: return true;
    default: return false;
  }
}

Facets::Facets(const Shape& shape, const MeshConfig& mesh, int dim, double width) : mesh_(mesh), dim_(dim) {
  if (shape.kind == ShapeKind::layer) {
    add_surface(*shape.top, true);
    add_surface(*shape.base, false);
  } else if (shape.kind == ShapeKind::stl) {
    surface_ = shape.triangles.get();
  } else if (shape.kind == ShapeKind::polygon) {
    add_outline(shape.polygon, dim == 3 ? shape.width[0] : 0, dim == 3 ? shape.width[1] : 1);
  } else if (dim == 2) {
    add_outline(disc_outline(shape, width), 0, 1);
  } else {
    const Polygon side =
        shape.kind == ShapeKind::disc ? ball_side(shape.radius, width) : revolved_side(shape);
    const Vec3 about =
        shape.kind == ShapeKind::disc ? shape.centre : Vec3{shape.centre[0], shape.centre[1], 0};
    add_revolved(side, about, width);
  }
}

void Facets::add(const Vec3& a, const Vec3& b, const Vec3& c) { flats_.push_back({3, {a, b, c, {}}}); }

void Facets::add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  flats_.push_back({4, {a, b, c, d}});
}

void Facets::add_surface(const HeightSurface& surface, bool upper) {
  const double y = dim_ == 3 ? mesh_.lower[1] : 0, z = dim_ == 3 ? mesh_.upper[1] : 1;
  const auto strip = [&](double a, double b, double at_a, double at_b) {
    if (upper)
      add({a, y, at_a}, {b, y, at_b}, {b, z, at_b}, {a, z, at_a});
    else
      add({a, z, at_a}, {b, z, at_b}, {b, y, at_b}, {a, y, at_a});
  };
  if (surface.is_level()) return strip(mesh_.lower[0], mesh_.upper[0], surface.at(0, 0), surface.at(0, 0));
  const auto [first, last] = surface.lines_around(0, mesh_.lower[0], mesh_.upper[0]);
  if (surface.lines(1).empty()) {
    for (std::size_t k = first; k < last; ++k)
      strip(surface.lines(0)[k], surface.lines(0)[k + 1], surface.node(k, 0), surface.node(k + 1, 0));
    return;
  }
  const auto [front, back] = surface.lines_around(1, mesh_.lower[1], mesh_.upper[1]);
  const std::size_t across = last - first, along = back - front;
  rasters_[upper ? 0 : 1] = {&surface, {first, front}, {across, along}, 4 * across * along, upper};
}

ConvexPiece Facets::Raster::operator[](std::size_t k) const {
  const std::size_t cell = k / 4, i = first[0] + cell % cells[0], j = first[1] + cell / cells[0];
  const auto &x = surface->lines(0), &y = surface->lines(1);
  const auto corner = [&](std::size_t a, std::size_t b) {
    return Vec3{x[i + a], y[j + b], surface->node(i + a, j + b)};
  };
  const Vec3 corners[4] = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
  Vec3 middle{(x[i] + x[i + 1]) / 2, (y[j] + y[j + 1]) / 2, 0};
  for (const Vec3& c : corners) middle[2] += c[2] / 4;
  ConvexPiece piece;
  const Vec3 &from = corners[k % 4], &to = corners[(k + 1) % 4];
  piece.add(middle);
  piece.add(upper ? from : to), piece.add(upper ? to : from);
  return piece;
}

/// Edges as strips along y.
void Facets::add_outline(const std::vector<std::array<double, 2>>& outline, double from, double to) {
  const bool anticlockwise = twice_area(outline) > 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    Point2 a = outline[k], b = outline[(k + 1) % outline.size()];
    if (!anticlockwise) std::swap(a, b);
    add({a[0], from, a[1]}, {a[0], to, a[1]}, {b[0], to, b[1]}, {b[0], from, b[1]});
  }
}

/// Frusta about a vertical axis, as trapezoids. The polygons across the axis have the area of their circles.
void Facets::add_revolved(const std::vector<std::array<double, 2>>& side, const Vec3& centre, double width) {
  double radius = 0;
  for (const Point2& point : side) radius = std::max(radius, point[0]);
  const int count = around(radius, width);
  const double step = 2 * k_pi / count, grown = std::sqrt(step / std::sin(step));
  const auto at = [&](const Point2& point, int k) {
    return Vec3{centre[0] + grown * point[0] * std::cos((k + 0.5) * step),
                centre[1] + grown * point[0] * std::sin((k + 0.5) * step), centre[2] + point[1]};
  };
  Polygon closed = side;  // with flat ends
  if (closed.front()[0] > 0) closed.insert(closed.begin(), {0, closed.front()[1]});
  if (closed.back()[0] > 0) closed.push_back({0, closed.back()[1]});
  for (std::size_t p = 0; p + 1 < closed.size(); ++p)
    for (int k = 0; k < count; ++k) {
      const Point2 &low = closed[p], &high = closed[p + 1];
      if (low[0] == 0)
        add(at(low, 0), at(high, k + 1), at(high, k));
      else if (high[0] == 0)
        add(at(low, k), at(low, k + 1), at(high, 0));
      else if (low[0] != high[0])
        add(at(low, k), at(low, k + 1), at(high, k + 1), at(high, k));
    }
}

ConvexPiece Facets::operator[](std::size_t k) const {
  ConvexPiece piece;
  if (k < flats_.size()) {
    for (int v = 0; v < flats_[k].count; ++v) piece.add(flats_[k].x[v]);
    return piece;
  }
  k -= flats_.size();
  if (k < triangles()) {
    for (int c = 0; c < 3; ++c) piece.add(surface_->corner(static_cast<int>(k), c));
    return piece;
  }
  k -= triangles();
  return k < rasters_[0].count ? rasters_[0][k] : rasters_[1][k - rasters_[0].count];
}

double Facets::volume() const {
  const int up = dim_ - 1;
  UnderPiece sum;
  const Vec3 origin{mesh_.lower[0], 0, mesh_.lower[up]};
  for (std::size_t k = 0; k < size(); ++k) {
    ConvexPiece piece = (*this)[k].between(0, mesh_.lower[0], mesh_.upper[0]);
    if (dim_ == 3 && piece.count > 0) piece = piece.between(1, mesh_.lower[1], mesh_.upper[1]);
    if (piece.count == 0) continue;
    // A part beyond the mesh in height counts as on the mesh's side.
    ConvexPiece below, rest, inside, above;
    piece.split(2, mesh_.lower[up], below, rest);
    rest.split(2, mesh_.upper[up], inside, above);
    for (int v = 0; v < above.count; ++v) above.x[v][2] = mesh_.upper[up];
    sum.add(inside, origin);
    sum.add(above, origin);
  }
  return sum.volume;
}

}  // namespace mpm
