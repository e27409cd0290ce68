#pragma once
// Signed distance to the surface of a rigid body, and its outward normal, at any point.

#include "data/surface.hpp"
#include "physics/sampled_surface.hpp"

namespace mpm {

/// On which side of a plane a point is, by its distance; 0 on the plane, and nearer to it than round-off [m].
KOKKOS_INLINE_FUNCTION double side_of(double x, double round_off) {
  return x > round_off ? 1 : (x < -round_off ? -1 : 0);
}

/// Largest component of a vector.
template <int N>
KOKKOS_INLINE_FUNCTION double largest_of(const Vector<double, N>& v) {
  double largest = v[0];
  for (int d = 1; d < N; ++d) largest = Kokkos::fmax(largest, v[d]);
  return largest;
}

/// A product of n intervals, given by how far the point is beyond each (`beyond` [m], negative inside) and
/// the outward direction of each; corners rounded by `radius` [m]. On an edge the first of its faces counts;
/// `share` is zero where several are as near to a point inside. round_off [m]: of places.
template <int N>
KOKKOS_INLINE_FUNCTION double distance_to_product(const Vector<double, N>& beyond, double radius,
                                                  double round_off, Vector<double, N>& share) {
  double outside = 0;
  int nearest = 0;
  for (int d = 0; d < N; ++d) {
    share[d] = Kokkos::fmax(0.0, beyond[d] + radius);
    outside += share[d] * share[d];
    if (beyond[d] > beyond[nearest] + round_off) nearest = d;
  }
  outside = Kokkos::sqrt(outside);
  if (outside > round_off) {
    for (int d = 0; d < N; ++d) share[d] /= outside;
    return outside - radius;
  }
  bool alone = true;
  for (int d = 0; d < N; ++d) alone = alone && (d == nearest || beyond[d] < beyond[nearest] - round_off);
  const bool counts = alone || beyond[nearest] > -round_off;
  for (int d = 0; d < N; ++d) share[d] = counts && d == nearest ? 1 : 0;
  return beyond[nearest];
}

/// Adds a vector to a sum, or begins it anew.
KOKKOS_INLINE_FUNCTION void add_or_begin(bool begins, const Vector<double, 2>& v, Vector<double, 2>& sum) {
  for (int d = 0; d < 2; ++d) sum[d] = (begins ? 0 : sum[d]) + v[d];
}

/// Distance in the plane to a polygon; edges on the mesh's boundary are no surface. round_off [m]: of places.
template <class Vertices>
KOKKOS_INLINE_FUNCTION Distance<2> distance_to_polygon(const Vertices& vertices, int first, int count,
                                                       double x, double z, double round_off) {
  double least = Kokkos::Experimental::finite_max<double>::value;
  Vector<double, 2> ways{}, faces{};  // from the nearest places; normals of their edges
  double turn = 0;                    // twice the area: which way round the polygon goes
  bool inside = false, turned = false;
  MPM_ROLLED
  for (int k = 0; k < count; ++k) {
    const Vertex a = vertices(first + k), b = vertices(first + (k + 1 == count ? 0 : k + 1));
    turn += a.x * b.z - b.x * a.z;
    if ((a.z > z) != (b.z > z) && x < a.x + (z - a.z) / (b.z - a.z) * (b.x - a.x)) inside = !inside;
    if (a.outside) continue;
    const double ex = b.x - a.x, ez = b.z - a.z, length2 = ex * ex + ez * ez;
    const double along = Kokkos::fmin(1.0, Kokkos::fmax(0.0, ((x - a.x) * ex + (z - a.z) * ez) / length2));
    const Vector<double, 2> way{x - a.x - along * ex, z - a.z - along * ez};
    const double length = Kokkos::sqrt(dot(way, way));
    if (length > least + round_off) continue;
    const bool nearer = length < least - round_off;
    add_or_begin(nearer, way, ways);
    const Vector<double, 2> face{ez / Kokkos::sqrt(length2), -ex / Kokkos::sqrt(length2)};
    add_or_begin(nearer, face, faces);
    if (nearer) least = length, turned = false;
    turned = turned || Kokkos::fabs(dot(face, way)) < k_edge * length;
  }
  const bool on_surface = !(least > round_off);
  const Vector<double, 2>& sum = on_surface ? faces : ways;
  const double length = Kokkos::sqrt(dot(sum, sum)), out = (on_surface ? turn < 0 : inside) ? -1 : 1;
  const double factor = length > (on_surface ? k_on_edge : round_off) ? out / length : 0;
  return {on_surface ? 0 : (inside ? -least : least), {factor * sum[0], factor * sum[1]}, turned};
}

/// Distance of a point, r from the centre, to what turns about the vertical axis.
template <class Vertices>
KOKKOS_INLINE_FUNCTION Distance<3> distance_to_revolved(const Surface<3>& body, const Vertices& vertices,
                                                        const Vector<double, 3>& r) {
  const double off = Kokkos::sqrt(r[0] * r[0] + r[1] * r[1]);
  const Distance<2> section =
      distance_to_polygon(vertices, body.first, body.count, off, r[2], body.round_off);
  const bool on_axis = !(off > body.round_off);
  const double x = on_axis ? 0 : r[0] / off, y = on_axis ? 0 : r[1] / off;
  const double value = section.value - body.radius;
  const double up = section.normal[1];
  if (on_axis && Kokkos::fabs(up) > k_on_edge)
    return {value, {0, 0, Kokkos::copysign(1.0, up)}, section.at_edge};
  return {value, {section.normal[0] * x, section.normal[0] * y, up}, section.at_edge};
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

/// Vertices of SurfaceTables, passed by value (SampleTables).
struct VertexTable {
  const Vertex* of;
  KOKKOS_INLINE_FUNCTION const Vertex& operator()(int v) const { return of[v]; }
};

/// Distance to the ground: that to the plane through the place below with the slope over two squares. All
/// below the ground is inside.
template <class Vertices>
MPM_CALLED_FUNCTION Distance<3> distance_to_heights(const Surface<3>& body, Vertices vertices, double x,
                                                    double y, double z) {
  const double h = body.radius;
  const double a = (height_at(body, vertices, x + h, y) - height_at(body, vertices, x - h, y)) / (2 * h),
               b = (height_at(body, vertices, x, y + h) - height_at(body, vertices, x, y - h)) / (2 * h);
  const double up = 1 / Kokkos::sqrt(1 + a * a + b * b);
  return {(z - height_at(body, vertices, x, y)) * up, {-a * up, -b * up, up}, false};
}

/// Distance to a surface of one part, as distance_to.
template <int Dim, class Vertices>
KOKKOS_INLINE_FUNCTION Distance<Dim> distance_to_part(const Surface<Dim>& body, const Vertices& vertices,
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
    if constexpr (Dim == 3 && requires { vertices.vertices.data(); })
      out = distance_to_heights(body, VertexTable{vertices.vertices.data()}, x[0], x[1], x[2]);
    else if constexpr (Dim == 3)
      out = distance_to_heights(body, vertices, x[0], x[1], x[2]);
  } else if (body.kind == SurfaceKind::sampled) {
    if constexpr (Dim == 3 && requires { vertices.samples; })
      out = distance_to_samples(SampleTables{&vertices.blocks(0), &vertices.samples(0), &vertices.edges(0)},
                                vertices.grids(body.first), x[0], x[1], x[2]);
  } else if (body.kind == SurfaceKind::box) {
    const double along = body.cosine * r[0] + body.sine * r[up];
    r[up] = body.cosine * r[up] - body.sine * r[0];
    r[0] = along;
    Vector<double, Dim> beyond, n;
    for (int d = 0; d < Dim; ++d) beyond[d] = Kokkos::fabs(r[d]) - body.half[d];
    out.value = distance_to_product<Dim>(beyond, body.radius, body.round_off, n);
    out.at_edge = largest_of(n) < 1 - k_on_edge;
    for (int d = 0; d < Dim; ++d) n[d] = side_of(r[d], body.round_off) * n[d];
    out.normal = n;
    out.normal[0] = body.cosine * n[0] - body.sine * n[up];
    out.normal[up] = body.cosine * n[up] + body.sine * n[0];
  } else {
    Distance<2> plane = distance_to_polygon(vertices, body.first, body.count, x[0], x[up], body.round_off);
    plane.value -= body.radius;
    if constexpr (Dim == 2) {
      out = plane;
    } else {
      Vector<double, 2> share;
      const Vector<double, 2> beyond{plane.value, Kokkos::fabs(r[1]) - body.half[1]};
      out.value = distance_to_product<2>(beyond, body.radius, body.round_off, share);
      out.at_edge = plane.at_edge || largest_of(share) < 1 - k_on_edge;
      out.normal = {share[0] * plane.normal[0], side_of(r[1], body.round_off) * share[1],
                    share[0] * plane.normal[1]};
    }
  }
  return out;
}

/// Signed distance of x [m from the mesh's lower corner, less the body's displacement]; that to a body of
/// several parts is that to the part which is nearest, or deepest round the point. vertices: of the polygons,
/// or SurfaceTables, which sampled surfaces and parts take. One loop for one part and several keeps the
/// kernels short.
template <int Dim, class Vertices>
KOKKOS_INLINE_FUNCTION Distance<Dim> distance_to(const Surface<Dim>& body, const Vertices& vertices,
                                                 const Vector<double, Dim>& x) {
  if constexpr (!requires { vertices.parts; }) {
    return distance_to_part(body, vertices, x);
  } else {
    const bool several = body.kind == SurfaceKind::parts;
    const Surface<Dim>* part = several ? &vertices.parts(body.first) : &body;
    const int count = several ? body.count : 1;
    Distance<Dim> least{Kokkos::Experimental::infinity_v<double>, {}, false};
    MPM_ROLLED
    for (int n = 0; n < count; ++n) {
      const Distance<Dim> other = distance_to_part(part[n], vertices, x);
      if (n == 0 || other.value < least.value) least = other;
    }
    return least;
  }
}

/// Number of the part of a body, in the order of all parts, that is nearest to x; -1: the body has one shape.
/// parts: surfaces of the parts of all bodies.
template <int Dim, class Tables>
KOKKOS_INLINE_FUNCTION int nearest_part(const Surface<Dim>& body, const Surface<Dim>* parts,
                                        const Tables& tables, const Vector<double, Dim>& x) {
  if (body.kind != SurfaceKind::parts) return -1;
  int nearest = body.first;
  double least = Kokkos::Experimental::infinity_v<double>;
  MPM_ROLLED
  for (int n = body.first; n < body.first + body.count; ++n) {
    const double distance = distance_to_part(parts[n], tables, x).value;
    if (distance < least) least = distance, nearest = n;
  }
  return nearest;
}

}  // namespace mpm
