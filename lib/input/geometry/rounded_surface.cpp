#include "input/geometry/rounded_surface.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

using Feature = TriangleDistance::Feature;

constexpr double k_edge = 0.866;     // cosine between the normals of faces, less is an edge
constexpr double k_bends = 0.9848;   // of 10 degrees: less is rounded
constexpr double k_alike = 0.9998;   // of 1 degree: planes of more are one
constexpr double k_touch = 0.02;     // of the radius: a ball may be so far outside
constexpr std::size_t k_planes = 8;  // at most
constexpr double k_none = 1e-12;     // m over the radius

/// Whether the faces at edge c of triangle k differ in direction.
bool bends(const TriangleDistance& of, int k, int c) {
  const int other = of.beyond(k, c);
  if (of.is_left_out(k)) return false;
  return other < 0 || inner_product(of.normal(k), of.normal(other)) < k_bends;
}

/// Whether the edge c of triangle k is convex and bends.
bool is_sharp(const TriangleDistance& of, int k, int c) {
  const int other = of.beyond(k, c);
  const Vec3 from = of.surface().corner(k, c);
  if (of.is_left_out(k)) return false;
  const Vec3 image = of.with_images(from, of.normal(k));
  if (other < 0) {  // meets its image
    const double square = inner_product(image, image);
    return 2 * square - 1 < k_bends;
  }
  if (inner_product(of.normal(k), of.normal(other)) >= k_bends) return false;
  double out = 0;  // m, of the other triangle's corners before this one's plane
  for (int e = 0; e < 3; ++e)
    out = std::max(out, inner_product(difference(of.surface().corner(other, e), from), of.normal(k)));
  double in = 0;
  for (int e = 0; e < 3; ++e)
    in = std::max(in, -inner_product(difference(of.surface().corner(other, e), from), of.normal(k)));
  return in > out;
}

/// Shares by which each plane moves a point to the nearest one behind all (Hildreth 1957).
template <class Planes>
Vec3 behind(const Planes& planes, double radius, const Vec3& x, std::vector<double>& share) {
  constexpr int k_sweeps = 60;
  share.assign(planes.size(), 0);
  Vec3 y = x;
  for (int sweep = 0; sweep < k_sweeps; ++sweep) {
    double most = 0;
    for (std::size_t n = 0; n < planes.size(); ++n) {
      const double beyond = inner_product(difference(y, planes[n].point), planes[n].normal) + radius;
      const double now = std::max(0.0, share[n] + beyond);
      y = along(y, share[n] - now, planes[n].normal);
      most = std::max(most, std::abs(share[n] - now));
      share[n] = now;
    }
    if (most < 1e-9 * radius) break;
  }
  return y;
}

}  // namespace

RoundedSurface::RoundedSurface(const TriangleDistance& sharp, double radius)
    : sharp_(sharp), radius_(radius) {
  const TriangleSurface& s = sharp.surface();
  std::vector<Box> edges, bent;
  for (int k = 0; k < s.size(); ++k)
    for (int c = 0; c < 3; ++c)
      if (sharp.beyond(k, c) < k && is_sharp(sharp, k, c)) {
        Box& box = edges.emplace_back();
        box.add(s.corner(k, c)), box.add(s.corner(k, (c + 1) % 3));
      }
  edges_ = BoxTree(std::move(edges));
  for (int k = 0; k < s.size(); ++k)
    for (int c = 0; c < 3; ++c)
      if (sharp.beyond(k, c) < k && bends(sharp, k, c)) {
        Box& box = bent.emplace_back();
        box.add(s.corner(k, c)), box.add(s.corner(k, (c + 1) % 3));
      }
  bends_ = BoxTree(std::move(bent));
}

bool RoundedSurface::bends_in(const Box& box) const {
  return bends_.any_near(box, [](int) { return true; });
}

bool RoundedSurface::is_near_edge(const Vec3& place) const {
  if (edges_.boxes().empty()) return false;
  Vec3 x = place;
  for (const Mirror& m : sharp_.mirrors())
    if (m.upper ? x[m.d] > m.place : x[m.d] < m.place) x[m.d] = 2 * m.place - x[m.d];
  Box box;
  for (const double r : {-2 * radius_, 2 * radius_}) box.add(Vec3{x[0] + r, x[1] + r, x[2] + r});
  return edges_.any_near(box, [](int) { return true; });
}

/// Adds the planes at the nearest place of the surface. From inside the body that across the way there; from
/// outside those of the faces that meet there.
void RoundedSurface::add_planes(const Vec3& from, const Nearest& to, Planes& planes) const {
  const auto add = [&](Vec3 normal) {
    for (int d = 0; d < 3; ++d)
      if (to.images[d]) normal[d] = -normal[d];
    for (const Plane& plane : planes)
      if (inner_product(plane.normal, normal) > k_alike &&
          std::abs(inner_product(difference(plane.point, to.point), normal)) < k_touch * radius_)
        return;
    if (planes.size() < k_planes) planes.push_back({normal, to.point});
  };
  if (to.value < -k_none * radius_) {
    const Vec3 normal = unit_of(difference(to.point, from));
    for (const Plane& plane : planes)
      if (inner_product(plane.normal, normal) > 1 - 1e-12) return;
    if (planes.size() < k_planes) planes.push_back({normal, to.point});
    return;
  }
  const auto add_with_image = [&](int k) {
    const Vec3& normal = sharp_.normal(k);
    add(normal);
    const Vec3 kept = sharp_.with_images(to.point, normal);
    if (inner_product(kept, kept) < 1 - 1e-9) add(along(normal, 2, difference(kept, normal)));
  };
  if (to.feature == Feature::corner)
    for (const int k : sharp_.round(sharp_.surface().triangle(to.triangle)[to.part]))
      if (!sharp_.is_left_out(k)) add_with_image(k);
  if (to.feature != Feature::corner) add_with_image(to.triangle);
  if (to.feature == Feature::edge && sharp_.beyond(to.triangle, to.part) >= 0)
    add_with_image(sharp_.beyond(to.triangle, to.part));
}

RoundedSurface::Distance RoundedSurface::sharp_at(const Vec3& x, const Nearest& to) const {
  Distance out{to.value, to.normal, false};
  const Vec3 way = difference(x, to.point);
  if (length_of(way) > 1e-9 * radius_) out.normal = along({}, to.value < 0 ? -1 : 1, unit_of(way));
  if (to.feature == Feature::edge) {
    const int other = sharp_.beyond(to.triangle, to.part);
    out.at_edge = other >= 0 && inner_product(sharp_.normal(to.triangle), sharp_.normal(other)) < k_edge;
  } else if (to.feature == Feature::corner) {
    for (const int k : sharp_.round(sharp_.surface().triangle(to.triangle)[to.part]))
      out.at_edge = out.at_edge || inner_product(sharp_.normal(to.triangle), sharp_.normal(k)) < k_edge;
  }
  return out;
}

/// Finds the centre of the ball that is nearest to x: behind all planes of the surface that are found to be
/// in its way. False where there is no such ball; `less` is then a smaller radius.
bool RoundedSurface::rounded_at(const Vec3& x, const Nearest& to, double radius, Distance& out,
                                double& less) const {
  constexpr int k_rounds = 8;
  Planes planes;
  std::vector<double> share;
  add_planes(x, to, planes);
  int guess = to.triangle;
  less = radius / 2;
  for (int round = 0; round < k_rounds; ++round) {
    const Vec3 centre = behind(planes, radius, x, share);
    const Nearest there = sharp_.nearest(centre, guess);
    guess = there.triangle;
    if (there.value > -radius * (1 - k_touch)) {
      const std::size_t before = planes.size();
      add_planes(centre, there, planes);
      for (std::size_t a = 0; a < planes.size(); ++a)
        for (std::size_t b = std::max(before, a + 1); b < planes.size(); ++b) {
          constexpr double k_opposite = -0.95;
          if (inner_product(planes[a].normal, planes[b].normal) > k_opposite) continue;
          const double thickness =
              -inner_product(difference(planes[a].point, planes[b].point), planes[b].normal);
          if (thickness < 2 * radius) less = std::clamp(thickness / 2 * 0.98, radius / 16, radius);
          if (thickness < 2 * radius * (1 - k_touch)) return false;
        }
      if (planes.size() == before) return false;
      continue;
    }
    const Vec3 way = difference(x, centre);
    const double length = length_of(way);
    out.value = length - radius;
    if (out.value - to.value > radius_ && out.value - to.value > radius * 1.01) {  // it recedes too far
      less = radius * std::max(0.25, radius_ / (out.value - to.value) * 0.98);
      return false;
    }
    out.normal = unit_of(way);
    out.at_edge = false;
    for (std::size_t a = 0; a < planes.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        out.at_edge = out.at_edge || (share[a] > k_touch * radius && share[b] > k_touch * radius &&
                                      inner_product(planes[a].normal, planes[b].normal) < k_edge);
    return true;
  }
  return false;
}

RoundedSurface::Distance RoundedSurface::at(const Vec3& x, int& guess, bool walks) const {
  const Nearest to = walks ? sharp_.walked(x, guess) : sharp_.nearest(x, guess);
  guess = to.triangle;
  Distance out = sharp_at(x, to);
  if (!(radius_ > 0) || to.value < -radius_ * (1 - k_touch) || !is_near_edge(to.point)) return out;
  constexpr int k_tries = 5;
  double radius = radius_, less = 0;
  for (int k = 0; k < k_tries; ++k, radius = less) {
    Distance rounded;
    if (to.value < -radius * (1 - k_touch)) return out;
    if (rounded_at(x, to, radius, rounded, less)) return rounded;
  }
  return out;
}

}  // namespace mpm
