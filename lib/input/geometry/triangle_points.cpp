#include "input/geometry/triangle_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "input/geometry/triangle_distance.hpp"
#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

/// An edge, with the normals of the two triangles at it.
struct EdgeOfTwo {
  Vec3 from, to, normal, beyond;
};

/// Finds points of triangles, none too near to another.
class TrianglePoints {
 public:
  TrianglePoints(const TriangleSurface& surface, double apart)
      : surface_(surface), apart_(apart), least_(apart / 2) {
    for (int k = 0; k < surface.size(); ++k)
      normals_.push_back(unit_of(outer_product(difference(surface.corner(k, 1), surface.corner(k, 0)),
                                               difference(surface.corner(k, 2), surface.corner(k, 0)))));
  }

  void add_vertices() {
    std::vector<Vec3> normal(surface_.vertices());
    for (int k = 0; k < surface_.size(); ++k)
      for (int c = 0; c < 3; ++c) {
        const Vec3 a = unit_of(difference(surface_.corner(k, (c + 1) % 3), surface_.corner(k, c))),
                   b = unit_of(difference(surface_.corner(k, (c + 2) % 3), surface_.corner(k, c)));
        const double angle = std::acos(std::clamp(inner_product(a, b), -1.0, 1.0));
        Vec3& sum = normal[surface_.triangle(k)[c]];
        sum = along(sum, angle, normals_[k]);
      }
    for (Vec3& n : normal) n = unit_of(n);
    std::vector<double> flat(normal.size(), 1);  // cosine of the angle to the farthest face
    for (int k = 0; k < surface_.size(); ++k)
      for (const int v : surface_.triangle(k))
        flat[v] = std::min(flat[v], inner_product(normal[v], normals_[k]));
    std::vector<int> order(normal.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return flat[a] < flat[b]; });
    for (const int v : order) add(surface_.vertex(v), normal[v]);
  }
  /// flat: those between triangles of one plane; else the others that point outwards.
  void add_edges(bool flat) {
    constexpr double k_flat = 1e-6;
    for (const auto& [ends, edge] : edges()) {
      const Vec3 way = difference(edge.to, edge.from);
      const double turn = inner_product(outer_product(edge.normal, edge.beyond), unit_of(way));
      if (turn < -k_flat || (turn < k_flat) != flat) continue;
      const int parts = parts_of(length_of(way));
      for (int n = 1; n < parts; ++n)
        add(along(edge.from, double(n) / parts, way), unit_of(along(edge.normal, 1, edge.beyond)));
    }
  }
  void add_faces() {
    for (int k = 0; k < surface_.size(); ++k) {
      const Vec3 a = surface_.corner(k, 0), u = difference(surface_.corner(k, 1), a),
                 v = difference(surface_.corner(k, 2), a);
      const double longest = std::max({length_of(u), length_of(v), length_of(difference(u, v))});
      const int parts = parts_of(longest);
      for (int i = 1; i < parts; ++i)
        for (int j = 1; i + j < parts; ++j)
          add(along(along(a, double(i) / parts, u), double(j) / parts, v), normals_[k]);
    }
  }
  std::vector<TrianglePoint> points() && { return std::move(points_); }

 private:
  /// Parts of a line of a length [m], so that its points are near enough to each other.
  int parts_of(double length) const { return static_cast<int>(std::ceil(length / apart_ - 1e-9)); }
  std::map<std::pair<int, int>, EdgeOfTwo> edges() const {
    std::map<std::pair<int, int>, EdgeOfTwo> out;
    for (int k = 0; k < surface_.size(); ++k)
      for (int c = 0; c < 3; ++c) {
        const int a = surface_.triangle(k)[c], b = surface_.triangle(k)[(c + 1) % 3];
        EdgeOfTwo& edge = out[std::minmax(a, b)];
        if (a < b)
          edge.from = surface_.vertex(a), edge.to = surface_.vertex(b), edge.normal = normals_[k];
        else
          edge.beyond = normals_[k];
      }
    return out;
  }
  void add(const Vec3& x, const Vec3& normal) {
    std::array<long, 3> at;
    for (int d = 0; d < 3; ++d) at[d] = std::lround(std::floor(x[d] / least_));
    for (int n = 0; n < 27; ++n) {
      const std::array<long, 3> near{at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1};
      const auto [from, to] = kept_.equal_range(near);
      for (auto p = from; p != to; ++p)
        if (length_of(difference(p->second, x)) < least_ * (1 - 1e-9)) return;
    }
    kept_.emplace(at, x);
    points_.push_back({x, normal, 0});
  }

  const TriangleSurface& surface_;
  double apart_, least_;       // m
  std::vector<Vec3> normals_;  // of triangles
  std::vector<TrianglePoint> points_;
  std::multimap<std::array<long, 3>, Vec3> kept_;
};

/// Radius of the largest ball that touches a surface at a point from inside, by bisection: smaller ones lie
/// in it.
double touching_radius(const TriangleDistance& distance, const TrianglePoint& point, double apart) {
  constexpr int k_halvings = 12;
  const double out = apart / 50, least = apart / 2;
  const auto fits = [&](double radius) {
    return -distance.nearest(along(point.x, -radius, point.normal)).value >= radius - out;
  };
  if (!fits(least)) return 0;
  const Box& bounds = distance.surface().bounds();
  double low = least, high = least;
  for (int d = 0; d < 3; ++d) high = std::max(high, (bounds.upper[d] - bounds.lower[d]) / 2);
  for (int n = 0; n < k_halvings; ++n) {
    const double middle = (low + high) / 2;
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

std::vector<TrianglePoint> triangle_points(const std::shared_ptr<const TriangleSurface>& surface,
                                           double apart, bool faces) {
  TrianglePoints points(*surface, apart);
  points.add_vertices();
  points.add_edges(/*flat*/ false);
  if (faces) {
    points.add_edges(/*flat*/ true);
    points.add_faces();
  }
  std::vector<TrianglePoint> found = std::move(points).points();
  const TriangleDistance distance(surface, {});
  for (TrianglePoint& point : found) point.radius = touching_radius(distance, point, apart);
  return found;
}

}  // namespace mpm
