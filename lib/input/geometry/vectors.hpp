#pragma once
// Sums and products of vectors in space.

#include <cmath>

#include "mpm/config.hpp"

namespace mpm {

inline Vec3 difference(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
/// a + s b.
inline Vec3 along(const Vec3& a, double s, const Vec3& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
inline double inner_product(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 outer_product(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length_of(const Vec3& a) { return std::sqrt(inner_product(a, a)); }
/// Unit vector along a vector; zero where the vector is.
inline Vec3 unit_of(const Vec3& a) {
  const double length = length_of(a);
  return along({}, length > 0 ? 1 / length : 0, a);
}

}  // namespace mpm
