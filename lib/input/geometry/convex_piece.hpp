#pragma once
// Convex plane polygons in space, cut by planes across the axes.

#include "mpm/config.hpp"

namespace mpm {

/// A convex plane polygon of a few vertices. Its area as seen from above is positive where the vertices are
/// anticlockwise from there.
struct ConvexPiece {
  static constexpr int k_most = 16;  // a quadrilateral that six planes cut has 10; round-off may add a few
  int count = 0;
  std::array<Vec3, k_most> x{};  // m

  void add(const Vec3& vertex) {
    if (count < k_most) x[count++] = vertex;
  }
  double lowest(int d) const {
    double least = x[0][d];
    for (int k = 1; k < count; ++k) least = x[k][d] < least ? x[k][d] : least;
    return least;
  }
  double highest(int d) const {
    double most = x[0][d];
    for (int k = 1; k < count; ++k) most = x[k][d] > most ? x[k][d] : most;
    return most;
  }
  /// The parts where coordinate d is at most, and at least, a value; either may have no vertices. A vertex on
  /// the plane belongs to both.
  void split(int d, double at, ConvexPiece& below, ConvexPiece& above) const {
    below.count = above.count = 0;
    for (int k = 0; k < count; ++k) {
      const Vec3 &a = x[k], &b = x[k + 1 == count ? 0 : k + 1];
      if (a[d] <= at) below.add(a);
      if (a[d] >= at) above.add(a);
      if ((a[d] < at && b[d] > at) || (a[d] > at && b[d] < at)) {
        const double part = (at - a[d]) / (b[d] - a[d]);
        Vec3 c;
        for (int e = 0; e < 3; ++e) c[e] = a[e] + part * (b[e] - a[e]);
        c[d] = at;
        below.add(c), above.add(c);
      }
    }
    if (below.count < 3) below.count = 0;
    if (above.count < 3) above.count = 0;
  }
  /// The part between two values of coordinate d.
  ConvexPiece between(int d, double low, double high) const {
    ConvexPiece rest, outside, inside;
    split(d, low, outside, rest);
    rest.split(d, high, inside, outside);
    return inside;
  }
};

/// Integrals over the place of a piece as seen from above, with z the height of the piece over a base: what
/// lies between the base and the piece.
struct UnderPiece {
  double area = 0, area_x = 0, area_y = 0;                      // of 1, x, y
  double volume = 0, moment_x = 0, moment_y = 0, moment_z = 0;  // of z, x z, y z, z^2 / 2

  /// Coordinates less those of `origin`.
  void add(const ConvexPiece& piece, const Vec3& origin) {
    for (int k = 1; k + 1 < piece.count; ++k) add_triangle(piece.x[0], piece.x[k], piece.x[k + 1], origin);
  }

 private:
  void add_triangle(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& o) {
    const double a = ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) / 2;
    const double x[3] = {p[0] - o[0], q[0] - o[0], r[0] - o[0]},
                 y[3] = {p[1] - o[1], q[1] - o[1], r[1] - o[1]},
                 z[3] = {p[2] - o[2], q[2] - o[2], r[2] - o[2]};
    const double sx = x[0] + x[1] + x[2], sy = y[0] + y[1] + y[2], sz = z[0] + z[1] + z[2];
    double xz = sx * sz, yz = sy * sz, zz = sz * sz;
    for (int k = 0; k < 3; ++k) xz += x[k] * z[k], yz += y[k] * z[k], zz += z[k] * z[k];
    area += a, area_x += a * sx / 3, area_y += a * sy / 3;
    volume += a * sz / 3, moment_x += a * xz / 12, moment_y += a * yz / 12, moment_z += a * zz / 24;
  }
};

}  // namespace mpm
