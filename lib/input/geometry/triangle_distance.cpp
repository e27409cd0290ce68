#include "input/geometry/triangle_distance.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

using Feature = TriangleDistance::Feature;

/// Place of a triangle that is nearest to a point, and the part that it is on (Ericson 2005, 5.1.5).
struct Foot {
  Vec3 point;
  Feature feature;
  int part;
};

Foot foot_on(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 ab = difference(b, a), ac = difference(c, a), ax = difference(x, a);
  const double d1 = inner_product(ab, ax), d2 = inner_product(ac, ax);
  if (d1 <= 0 && d2 <= 0) return {a, Feature::corner, 0};
  const Vec3 bx = difference(x, b);
  const double d3 = inner_product(ab, bx), d4 = inner_product(ac, bx);
  if (d3 >= 0 && d4 <= d3) return {b, Feature::corner, 1};
  const double of_c = d1 * d4 - d3 * d2;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return {along(a, d1 / (d1 - d3), ab), Feature::edge, 0};
  const Vec3 cx = difference(x, c);
  const double d5 = inner_product(ab, cx), d6 = inner_product(ac, cx);
  if (d6 >= 0 && d5 <= d6) return {c, Feature::corner, 2};
  const double of_b = d5 * d2 - d1 * d6;
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return {along(a, d2 / (d2 - d6), ac), Feature::edge, 2};
  const double of_a = d3 * d6 - d5 * d4;
  if (of_a <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return {along(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), difference(c, b)), Feature::edge, 1};
  const double share = 1 / (of_a + of_b + of_c);
  return {along(along(a, of_b * share, ab), of_c * share, ac), Feature::face, 0};
}

/// Angle of a triangle at a corner [rad].
double angle_at(const Vec3& corner, const Vec3& next, const Vec3& other) {
  const Vec3 u = difference(next, corner), v = difference(other, corner);
  return std::atan2(length_of(outer_product(u, v)), inner_product(u, v));
}

}  // namespace

TriangleDistance::TriangleDistance(std::shared_ptr<const TriangleSurface> surface,
                                   std::vector<Mirror> mirrors)
    : surface_(std::move(surface)), mirrors_(std::move(mirrors)) {
  const TriangleSurface& s = *surface_;
  double extent = 0;
  for (int d = 0; d < 3; ++d) extent = std::max(extent, s.bounds().upper[d] - s.bounds().lower[d]);
  slack_ = 1e-7 * extent;  // the file's numbers have seven digits
  for (int k = 0; k < s.size(); ++k) {
    const Vec3 a = s.corner(k, 0), b = s.corner(k, 1), c = s.corner(k, 2);
    normals_.push_back(unit_of(outer_product(difference(b, a), difference(c, a))));
    bool on = false;
    for (const Mirror& m : mirrors_)
      on = on || std::max({std::abs(a[m.d] - m.place), std::abs(b[m.d] - m.place),
                           std::abs(c[m.d] - m.place)}) < slack_;
    left_out_.push_back(on);
  }
  set_neighbours();
  set_corners();
}

void TriangleDistance::set_neighbours() {
  const TriangleSurface& s = *surface_;
  first_.assign(s.vertices() + 2, 0);
  for (int k = 0; k < s.size(); ++k)
    for (const int v : s.triangle(k)) ++first_[v + 2];
  for (std::size_t v = 2; v < first_.size(); ++v) first_[v] += first_[v - 1];
  list_.resize(3 * s.size());
  for (int k = 0; k < s.size(); ++k)
    for (const int v : s.triangle(k)) list_[first_[v + 1]++] = k;
  beyond_.assign(3 * s.size(), -1);
  for (int k = 0; k < s.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      const int from = s.triangle(k)[c], to = s.triangle(k)[(c + 1) % 3];
      for (int n = first_[from]; n < first_[from + 1]; ++n) {
        const auto& other = s.triangle(list_[n]);
        for (int e = 0; e < 3; ++e)
          if (other[e] == to && other[(e + 1) % 3] == from && !left_out_[list_[n]])
            beyond_[3 * k + c] = list_[n];
      }
    }
}

void TriangleDistance::set_corners() {
  const TriangleSurface& s = *surface_;
  corners_.resize(s.vertices());
  for (int k = 0; k < s.size(); ++k)
    for (int c = 0; c < 3 && !left_out_[k]; ++c) {
      const double angle = angle_at(s.corner(k, c), s.corner(k, (c + 1) % 3), s.corner(k, (c + 2) % 3));
      Vec3& sum = corners_[s.triangle(k)[c]];
      sum = along(sum, angle, normals_[k]);
    }
  for (int v = 0; v < s.vertices(); ++v) corners_[v] = unit_of(with_images(s.vertex(v), corners_[v]));
}

Vec3 TriangleDistance::with_images(const Vec3& at, Vec3 v) const {
  for (const Mirror& m : mirrors_)
    if (std::abs(at[m.d] - m.place) < slack_) v[m.d] = 0;
  return v;
}

std::vector<int> TriangleDistance::round(int vertex) const {
  return {list_.begin() + first_[vertex], list_.begin() + first_[vertex + 1]};
}

Vec3 TriangleDistance::pseudo_normal(const Nearest& of) const {
  if (of.feature == Feature::face) return normals_[of.triangle];
  if (of.feature == Feature::corner) return corners_[surface_->triangle(of.triangle)[of.part]];
  const int other = beyond(of.triangle, of.part);
  if (other < 0) return unit_of(with_images(of.point, normals_[of.triangle]));
  return unit_of(along(normals_[of.triangle], 1, normals_[other]));
}

/// Takes a triangle that is nearer than `least` [m2]; whether it is.
bool TriangleDistance::approach(const Vec3& x, int k, double& least, Nearest& out) const {
  if (left_out_[k]) return false;
  const TriangleSurface& s = *surface_;
  const Foot foot = foot_on(s.corner(k, 0), s.corner(k, 1), s.corner(k, 2), x);
  const Vec3 way = difference(x, foot.point);
  const double square = inner_product(way, way);
  if (!(square < least)) return false;
  least = square;
  out.point = foot.point, out.feature = foot.feature, out.part = foot.part, out.triangle = k;
  return true;
}

/// The point, or its image on the side of the mirrors where the surface is.
Vec3 TriangleDistance::before_mirrors(const Vec3& at, Nearest& out) const {
  Vec3 x = at;
  for (const Mirror& m : mirrors_)
    if (m.upper ? x[m.d] > m.place : x[m.d] < m.place) {
      x[m.d] = 2 * m.place - x[m.d];
      out.images[m.d] = !out.images[m.d];
    }
  return x;
}

/// Finds sign and normal at the nearest place, for a point whose image before the mirrors is x.
void TriangleDistance::finish(const Vec3& at, const Vec3& x, double least, Nearest& out) const {
  if (out.triangle < 0) return;
  out.normal = pseudo_normal(out);
  const double length = std::sqrt(least), across = inner_product(difference(x, out.point), out.normal);
  // Nearly along the surface, as at a needle's edge, round-off may turn the sign of the product.
  constexpr double k_sure = 1e-6;
  const bool inside =
      std::abs(across) > k_sure * length || !mirrors_.empty() ? across < 0 : surface_->holds(x, 0);
  out.value = inside ? -length : length;
  for (const Mirror& m : mirrors_)
    if (out.images[m.d] && (m.upper ? at[m.d] > m.place : at[m.d] < m.place)) {
      out.point[m.d] = 2 * m.place - out.point[m.d];
      out.normal[m.d] = -out.normal[m.d];
    }
}

TriangleDistance::Nearest TriangleDistance::nearest(const Vec3& at, int guess, double limit) const {
  Nearest out;
  const Vec3 x = before_mirrors(at, out);
  double least = limit * limit;
  if (guess >= 0) approach(x, guess, least, out);
  surface_->tree().visit_nearest(x, least, [&](int k) { approach(x, k, least, out); });
  finish(at, x, least, out);
  return out;
}

TriangleDistance::Nearest TriangleDistance::walked(const Vec3& at, int from) const {
  Nearest out;
  const Vec3 x = before_mirrors(at, out);
  double least = Box::k_none;
  bool nearer = approach(x, from, least, out);
  while (nearer) {
    nearer = false;
    if (out.feature == Feature::edge) {
      const int other = beyond(out.triangle, out.part);
      nearer = other >= 0 && approach(x, other, least, out);
    } else if (out.feature == Feature::corner) {
      const int v = surface_->triangle(out.triangle)[out.part];
      for (int n = first_[v]; n < first_[v + 1]; ++n) nearer = approach(x, list_[n], least, out) || nearer;
    }
  }
  finish(at, x, least, out);
  return out;
}

}  // namespace mpm
