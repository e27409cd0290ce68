#include "input/geometry/mass_properties.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/revolution.hpp"
#include "input/geometry/polygon.hpp"
#include "input/geometry/region.hpp"
#include "input/geometry/revolved.hpp"
#include "input/geometry/shapes.hpp"
#include "input/geometry/triangle_surface.hpp"
#include "input/geometry/united.hpp"

namespace mpm {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr int k_axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};  // components of a Sym6

/// Integrals over a solid, from an origin inside its bounds: differences of large coordinates would lose
/// digits.
struct Moments {
  double volume = 0;  // m3 (m2 in 2D)
  Vec3 first{};       // m4 (m3), of the coordinates
  Sym6 second{};      // m5 (m4), of their products
};

/// Inertia tensor of the products of coordinates.
Sym6 inertia_of(const Sym6& second, int dim) {
  const auto [xx, yy, zz, xy, yz, zx] = second;
  if (dim == 2) return {0, 0, xx + yy, 0, 0, 0};
  return {yy + zz, zz + xx, xx + yy, -xy, -yz, -zx};
}

/// Moves the moments from the origin [m] to the centre of mass (parallel axes).
MassProperties about_centre(const Moments& from, const Vec3& origin, int dim) {
  Vec3 centre = origin;
  for (int d = 0; d < dim; ++d) centre[d] += from.first[d] / from.volume;
  Sym6 second = from.second;
  for (int k = 0; k < 6; ++k) second[k] -= from.first[k_axes[k][0]] * from.first[k_axes[k][1]] / from.volume;
  return {from.volume, centre, inertia_of(second, dim)};
}

/// Moments, about its centre, of a box of edges [m] and all points within the radius r [m] of it. For each
/// set of directions, the points that lie beyond the box in these directions only are the sectors of a ball
/// in these directions, moved apart by the edges, times the other edges: prisms on faces, quarters of
/// cylinders along edges, eighths of a ball at corners.
Moments rounded_box(const Vec3& edges, double r, int dim) {
  // Ball of radius 1 in 0 to 3 directions: its volume, and the mean distance to a plane through its centre.
  constexpr double k_ball[] = {1, 2, k_pi, 4 * k_pi / 3}, k_distance[] = {0, 0.5, 4 / (3 * k_pi), 0.375};
  Moments sum;
  for (int set = 0; set < 1 << dim; ++set) {
    int beyond = 0;
    double volume = 1;
    for (int d = 0; d < dim; ++d) {
      const bool is_beyond = set >> d & 1;
      beyond += is_beyond;
      volume *= is_beyond ? r : edges[d];
    }
    volume *= k_ball[beyond];
    sum.volume += volume;
    for (int d = 0; d < dim; ++d) {
      const double e = edges[d];
      const double rounded = r * r / (beyond + 2) + e * r * k_distance[beyond] + e * e / 4;
      sum.second[d] += volume * (set >> d & 1 ? rounded : e * e / 12);
    }
  }
  return sum;
}

MassProperties box_properties(const Shape& shape, int dim) {
  Vec3 edges{}, middle{};
  for (int d = 0; d < dim; ++d) {
    edges[d] = std::max(0.0, shape.upper[d] - shape.lower[d] - 2 * shape.fillet);
    middle[d] = shape.lower[d] + (shape.upper[d] - shape.lower[d]) / 2;
  }
  Moments box = rounded_box(edges, shape.fillet, dim);
  if (dim == 3) {
    const double c = std::cos(shape.angle), s = std::sin(shape.angle);
    const double along = box.second[0], up = box.second[2];
    box.second[0] = c * c * along + s * s * up;
    box.second[2] = s * s * along + c * c * up;
    box.second[5] = c * s * (along - up);
  }
  return about_centre(box, turned(middle, shape.lower, shape.angle, dim), dim);
}

MassProperties ball_properties(const Shape& shape, int dim) {
  Vec3 centre{};
  for (int d = 0; d < dim; ++d) centre[d] = shape.centre[d];
  return about_centre(rounded_box({}, shape.radius, dim), centre, dim);
}

/// Adds the simplex of the origin and as many corners [m] as it has directions (Tonon 2005).
template <std::size_t N>
void add_simplex(double volume, const std::array<Vec3, N>& corners, Moments& sum) {
  Vec3 total{};
  for (const Vec3& x : corners)
    for (int d = 0; d < 3; ++d) total[d] += x[d];
  sum.volume += volume;
  for (int d = 0; d < 3; ++d) sum.first[d] += volume * total[d] / (N + 1);
  for (int k = 0; k < 6; ++k) {
    const auto [a, b] = k_axes[k];
    double products = total[a] * total[b];
    for (const Vec3& x : corners) products += x[a] * x[b];
    sum.second[k] += volume * products / ((N + 1) * (N + 2));
  }
}

MassProperties prism_properties(const Shape& shape, int dim) {
  const int up = dim - 1;
  Box bounds;
  for (const Point2& point : shape.polygon) bounds.add(Vec3{point[0], point[1], 0});
  const Point2 middle{(bounds.lower[0] + bounds.upper[0]) / 2, (bounds.lower[1] + bounds.upper[1]) / 2};
  const double sense = signed_area_of(shape.polygon) > 0 ? 1 : -1;
  const double width = dim == 3 ? shape.width[1] - shape.width[0] : 1;
  Moments sum;
  for (std::size_t k = 0; k < shape.polygon.size(); ++k) {
    const auto [from, to] = edge_of(shape.polygon, k);
    std::array<Vec3, 2> corners{};
    corners[0][0] = from[0] - middle[0], corners[0][up] = from[1] - middle[1];
    corners[1][0] = to[0] - middle[0], corners[1][up] = to[1] - middle[1];
    const double area = (corners[0][0] * corners[1][up] - corners[0][up] * corners[1][0]) / 2;
    add_simplex(sense * area * width, corners, sum);
  }
  Vec3 origin{};
  if (dim == 3) origin[1] = shape.width[0] + width / 2, sum.second[1] = sum.volume * width * width / 12;
  origin[0] = middle[0], origin[up] = middle[1];
  return about_centre(sum, origin, dim);
}

/// Adds the frustum between the radii a at height z and b at height z + h [m], about the z axis.
void add_frustum(double z, double h, double a, double b, Moments& sum) {
  const double volume = k_pi * h / 3 * (a * a + a * b + b * b);
  const double above = k_pi * h * h / 12 * (a * a + 2 * a * b + 3 * b * b);  // m4, of the height above z
  const double square = k_pi * h * h * h / 30 * (a * a + 3 * a * b + 6 * b * b);
  const double across = k_pi * h / 20 * (((a + b) * a + b * b) * a * a + (a + b) * b * b * b);
  sum.volume += volume;
  sum.first[2] += above + z * volume;
  sum.second[0] += across, sum.second[1] += across;
  sum.second[2] += square + 2 * z * above + z * z * volume;
}

MassProperties revolved_properties(const Shape& shape) {
  const Polygon section = section_of(shape, 0, 0);  // first its side at positive distances, upwards
  const auto [low, high] = ends_of(shape);
  const double middle = low + (high - low) / 2;
  Moments sum;
  for (std::size_t k = 1; k < section.size() && section[k][0] >= 0; ++k) {
    const auto& [a, from] = section[k - 1];
    const auto& [b, to] = section[k];
    add_frustum(from - middle, to - from, a, b, sum);
  }
  return about_centre(sum, {shape.centre[0], shape.centre[1], middle}, 3);
}

/// Sums the tetrahedra of the triangles and the middle of their bounds (divergence theorem).
MassProperties surface_properties(const TriangleSurface& surface) {
  Vec3 origin;
  for (int d = 0; d < 3; ++d) origin[d] = (surface.bounds().lower[d] + surface.bounds().upper[d]) / 2;
  Moments sum;
  for (int k = 0; k < surface.size(); ++k) {
    std::array<Vec3, 3> x;
    for (int c = 0; c < 3; ++c)
      for (int d = 0; d < 3; ++d) x[c][d] = surface.corner(k, c)[d] - origin[d];
    const auto& [a, b, c] = x;
    const double six_volumes = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                               a[2] * (b[0] * c[1] - b[1] * c[0]);
    add_simplex(six_volumes / 6, x, sum);
  }
  return about_centre(sum, origin, 3);
}

/// A shape of which boxes end at the mirror image of their other end where a plane of symmetry cuts them.
Shape with_image(Shape shape, const MeshConfig& mesh, int dim) {
  for (Shape& part : shape.parts) part = with_image(part, mesh, dim);
  if (shape.kind != ShapeKind::box) return shape;
  const Cuts cuts = cuts_of(shape, mesh, dim);
  for (int d = 0; d < dim; ++d) {
    if (cuts[d][0]) shape.lower[d] = 2 * mesh.lower[d] - shape.upper[d];
    if (cuts[d][1]) shape.upper[d] = 2 * mesh.upper[d] - shape.lower[d];
  }
  return shape;
}

}  // namespace

std::optional<MassProperties> mass_properties(const Shape& shape, int dim) {
  switch (shape.kind) {
    case ShapeKind::box: return box_properties(shape, dim);
    case ShapeKind::polygon: return prism_properties(shape, dim);
    case ShapeKind::disc: return ball_properties(shape, dim);
    case ShapeKind::cylinder:
    case ShapeKind::cone: return revolved_properties(shape);
    case ShapeKind::stl: return surface_properties(*shape.triangles);
    case ShapeKind::parts: return united_properties(shape, dim);
    default: return std::nullopt;
  }
}

double mass_of(const Config& config, const RigidConfig& rigid) {
  if (rigid.mass) return *rigid.mass;
  const Bounds bounds = within(bounds_of(rigid.shape, config.mesh, config.dim), config.mesh, config.dim);
  const auto whole = mass_properties(rigid.shape, config.dim);
  const bool is_whole = whole && !cuts_of(rigid.shape, config.mesh, config.dim)[0][0];
  const double radius = is_whole ? whole->centre[0] : (bounds.lower[0] + bounds.upper[0]) / 2;
  return rigid.density * shape_volume(rigid.shape, config.mesh, config.dim) * revolved_length(config, radius);
}

std::optional<MassProperties> whole_properties(const Shape& shape, const MeshConfig& mesh, int dim) {
  return mass_properties(with_image(shape, mesh, dim), dim);
}

}  // namespace mpm
