#include "input/geometry/thickness.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

/// Thickness inwards from a point, at most `most` [m].
double thickness_at(const TriangleSurface& surface, const Vec3& x, const Vec3& inward, double most) {
  constexpr int k_steps = 12;
  for (int n = 1; n <= k_steps; ++n) {
    const double way = most * n / k_steps;
    if (!surface.holds(along(x, way, inward), 0)) return way;
  }
  return most;
}

}  // namespace

std::optional<Thickness> thinnest_twentieth(const TriangleSurface& surface, double most) {
  constexpr int k_points = 2000, k_twentieth = k_points / 20;
  const double share = surface.area() / k_points;
  std::vector<Thickness> found;
  double passed = 0;  // area of triangles before
  for (int k = 0; k < surface.size(); ++k) {
    const Vec3 a = surface.corner(k, 0), u = difference(surface.corner(k, 1), a),
               v = difference(surface.corner(k, 2), a), twice = outer_product(u, v);
    const double area = length_of(twice) / 2;
    for (; passed + area > share * (static_cast<double>(found.size()) + 0.5);) {
      // Places of a triangle by multiples of the golden ratio and of its square (Roberts 2018).
      const double n = static_cast<double>(found.size()), p = std::fmod(0.7548776662 * n, 1),
                   q = std::fmod(0.5698402910 * n, 1);
      const bool beyond = p + q > 1;
      const Vec3 x = along(along(a, beyond ? 1 - p : p, u), beyond ? 1 - q : q, v);
      found.push_back({thickness_at(surface, x, along({}, -1, unit_of(twice)), most), x});
    }
    passed += area;
  }
  if (found.size() <= k_twentieth) return {};
  const auto thinner = [](const Thickness& one, const Thickness& other) { return one.value < other.value; };
  std::nth_element(found.begin(), found.begin() + k_twentieth, found.end(), thinner);
  const Thickness& least = found[k_twentieth];
  return least.value < most ? std::optional(least) : std::nullopt;
}

}  // namespace mpm
