#pragma once
// Signed distance to the surface of a rigid body, and its outward normal, at any point.

#include "base/types.hpp"
#include "data/surface.hpp"

namespace mpm {

/// Signed distance [m], positive outside, and the outward unit normal there.
template <int Dim>
struct Distance {
  double value;
  Vector<double, Dim> normal;
};

inline constexpr double k_on_edge = 1e-9;  // m, less is round-off and tells no direction

/// A product of n intervals, given by how far the point is beyond each (`beyond` [m], negative inside) and
/// the outward direction of each; corners rounded by `radius` [m]. On an edge the first of its faces counts.
template <int N>
KOKKOS_INLINE_FUNCTION double distance_to_product(const Vector<double, N>& beyond, double radius,
                                                  Vector<double, N>& share) {
  double outside = 0;
  int nearest = 0;
  for (int d = 0; d < N; ++d) {
    share[d] = Kokkos::fmax(0.0, beyond[d] + radius);
    outside += share[d] * share[d];
    if (beyond[d] > beyond[nearest] + k_on_edge) nearest = d;
  }
  outside = Kokkos::sqrt(outside);
  if (outside > k_on_edge) {
    for (int d = 0; d < N; ++d) share[d] /= outside;
    return outside - radius;
  }
  for (int d = 0; d < N; ++d) share[d] = d == nearest ? 1 : 0;
  return beyond[nearest];
}

/// Distance in the plane to a polygon; edges on the mesh's boundary are no surface.
template <class Vertices>
KOKKOS_INLINE_FUNCTION Distance<2> distance_to_polygon(const Vertices& vertices, int first, int count,
                                                       double x, double z) {
  double least = Kokkos::Experimental::finite_max<double>::value, to_x = 0, to_z = 0, edge_x = 0, edge_z = 1;
  double turn = 0;  // twice the area: which way round the polygon goes
  bool inside = false;
  MPM_ROLLED
  for (int k = 0; k < count; ++k) {
    const Vertex a = vertices(first + k), b = vertices(first + (k + 1 == count ? 0 : k + 1));
    turn += a.x * b.z - b.x * a.z;
    if ((a.z > z) != (b.z > z) && x < a.x + (z - a.z) / (b.z - a.z) * (b.x - a.x)) inside = !inside;
    if (a.outside) continue;
    const double ex = b.x - a.x, ez = b.z - a.z, length2 = ex * ex + ez * ez;
    const double along = Kokkos::fmin(1.0, Kokkos::fmax(0.0, ((x - a.x) * ex + (z - a.z) * ez) / length2));
    const double dx = x - a.x - along * ex, dz = z - a.z - along * ez, square = dx * dx + dz * dz;
    if (square + k_on_edge * k_on_edge >= least) continue;  // a vertex is the first edge's
    least = square, to_x = dx, to_z = dz;
    edge_x = ez / Kokkos::sqrt(length2), edge_z = -ex / Kokkos::sqrt(length2);
  }
  const double length = Kokkos::sqrt(least), sign = inside ? -1 : 1;
  if (length > k_on_edge) return {sign * length, {sign * to_x / length, sign * to_z / length}};
  const double out = turn > 0 ? 1 : -1;
  return {0, {out * edge_x, out * edge_z}};
}

/// Distance of a point, r from the centre, to what turns about the vertical axis.
template <class Vertices>
KOKKOS_INLINE_FUNCTION Distance<3> distance_to_revolved(const Surface<3>& body, const Vertices& vertices,
                                                        const Vector<double, 3>& r) {
  const double off = Kokkos::sqrt(r[0] * r[0] + r[1] * r[1]);
  const Distance<2> section = distance_to_polygon(vertices, body.first, body.count, off, r[2]);
  const double value = section.value - body.radius;
  if (off > k_on_edge) {
    const double x = r[0] / off, y = r[1] / off;
    return {value, {section.normal[0] * x, section.normal[0] * y, section.normal[1]}};
  }
  // On the axis the normals all round add up to one along it. Next to a shaft every direction is as good.
  if (Kokkos::fabs(section.normal[1]) > k_on_edge)
    return {value, {0, 0, Kokkos::copysign(1.0, section.normal[1])}};
  return {value, {section.normal[0], 0, 0}};
}

/// Height of the ground at a point [m], linear in each direction between the places where it is given; beyond
/// them that of the nearest one.
template <class Vertices>
KOKKOS_INLINE_FUNCTION double height_at(const Surface<3>& body, const Vertices& vertices, double x,
                                        double y) {
  const int last_column = body.columns - 1, last_row = body.count / body.columns - 1;
  const double u = Kokkos::fmin(double(last_column), Kokkos::fmax(0.0, (x - body.centre[0]) / body.radius)),
               v = Kokkos::fmin(double(last_row), Kokkos::fmax(0.0, (y - body.centre[1]) / body.radius));
  const int i = Kokkos::min(static_cast<int>(u), last_column - 1),
            j = Kokkos::min(static_cast<int>(v), last_row - 1), at = body.first + j * body.columns + i;
  const double s = u - i, t = v - j;
  return (1 - t) * ((1 - s) * vertices(at).z + s * vertices(at + 1).z) +
         t * ((1 - s) * vertices(at + body.columns).z + s * vertices(at + body.columns + 1).z);
}

/// Distance to the ground: that to the plane through the place below with the slope over two squares. All
/// below the ground is inside.
template <class Vertices>
MPM_CALLED_FUNCTION Distance<3> distance_to_heights(const Surface<3>& body, const Vertices& vertices,
                                                    double x, double y, double z) {
  const double h = body.radius;
  const double a = (height_at(body, vertices, x + h, y) - height_at(body, vertices, x - h, y)) / (2 * h),
               b = (height_at(body, vertices, x, y + h) - height_at(body, vertices, x, y - h)) / (2 * h);
  const double up = 1 / Kokkos::sqrt(1 + a * a + b * b);
  return {(z - height_at(body, vertices, x, y)) * up, {-a * up, -b * up, up}};
}

/// Signed distance of x [m from the mesh's lower corner, less the body's displacement].
template <int Dim, class Vertices>
KOKKOS_INLINE_FUNCTION Distance<Dim> distance_to(const Surface<Dim>& body, const Vertices& vertices,
                                                 const Vector<double, Dim>& x) {
  constexpr int up = Dim - 1;
  Distance<Dim> out{};
  Vector<double, Dim> r;
  for (int d = 0; d < Dim; ++d) r[d] = x[d] - body.centre[d];
  if (body.kind == SurfaceKind::half_plane) {
    out.normal = body.normal;
    out.value = dot(r, body.normal);
  } else if (body.kind == SurfaceKind::disc) {
    const double length = Kokkos::sqrt(dot(r, r));
    out.value = length - body.radius;
    for (int d = 0; d < Dim; ++d) out.normal[d] = length > 0 ? r[d] / length : 0;
  } else if (body.kind == SurfaceKind::revolved) {
    if constexpr (Dim == 3) out = distance_to_revolved(body, vertices, r);
  } else if (body.kind == SurfaceKind::heights) {
    if constexpr (Dim == 3) out = distance_to_heights(body, vertices, x[0], x[1], x[2]);
  } else if (body.kind == SurfaceKind::box) {
    const double along = body.cosine * r[0] + body.sine * r[up];
    r[up] = body.cosine * r[up] - body.sine * r[0];
    r[0] = along;
    Vector<double, Dim> beyond, n;
    for (int d = 0; d < Dim; ++d) beyond[d] = Kokkos::fabs(r[d]) - body.half[d];
    out.value = distance_to_product<Dim>(beyond, body.radius, n);
    for (int d = 0; d < Dim; ++d) n[d] = Kokkos::copysign(n[d], r[d]);
    out.normal = n;
    out.normal[0] = body.cosine * n[0] - body.sine * n[up];
    out.normal[up] = body.cosine * n[up] + body.sine * n[0];
  } else {
    const Distance<2> plane = distance_to_polygon(vertices, body.first, body.count, x[0], x[up]);
    if constexpr (Dim == 2) {
      out = plane;
    } else {
      Vector<double, 2> share;
      const Vector<double, 2> beyond{plane.value, Kokkos::fabs(r[1]) - body.half[1]};
      out.value = distance_to_product<2>(beyond, 0, share);
      out.normal = {share[0] * plane.normal[0], Kokkos::copysign(share[1], r[1]), share[0] * plane.normal[1]};
    }
  }
  return out;
}

}  // namespace mpm
