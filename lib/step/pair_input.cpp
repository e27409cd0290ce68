#include "step/pair_input.hpp"

#include <algorithm>
#include <cmath>

#include "common/rigid_contact.hpp"
#include "input/geometry/shapes.hpp"
#include "step/surface_input.hpp"

namespace mpm {
namespace {

constexpr double k_apart = 0.5;    // cells, between points of a surface at most
constexpr double k_inward = 0.05;  // cells, from a point to the place inside at most
constexpr double k_thin = 0.05;    // of the shortest edge of the bounds, likewise
constexpr double k_flush = 1e-3;   // cells: nearer to a side of the mesh a body is on it

/// Points of a surface that are in the mesh.
class SurfacePoints {
 public:
  SurfacePoints(const Config& config, double inward, PairBodyInput& to)
      : mesh_(config.mesh), dim_(config.dim), inward_(inward), to_(to) {}

  /// x, from the mesh's lower corner [m]; inward: each component a multiple of the way inward.
  void add(const Vec3& x, Vec3 inward) {
    for (int d = 0; d < dim_; ++d) {
      const double slack = k_flush * mesh_.spacing;
      if (x[d] < -slack || x[d] > mesh_.upper[d] - mesh_.lower[d] + slack) return;
      inward[d] *= inward_;
    }
    to_.points.push_back(x), to_.inward.push_back(inward);
  }
  /// Places between two ends of a line, without them, as shares of its length [m].
  std::vector<double> between(double length) const {
    const int parts = static_cast<int>(std::ceil(length / (k_apart * mesh_.spacing) - 1e-9));
    std::vector<double> out;
    for (int n = 1; n < parts; ++n) out.push_back(static_cast<double>(n) / parts);
    return out;
  }

 private:
  const MeshConfig& mesh_;
  int dim_;
  double inward_;
  PairBodyInput& to_;
};

/// Corners, edges and, of bodies that move, faces of a box. The core of a rounded box has them.
void add_box(const SurfaceInput& box, int dim, bool faces, SurfacePoints& to, PairBodyInput& body) {
  const double cosine = std::cos(box.angle), sine = std::sin(box.angle);
  const auto turned = [&](const Vec3& v) {
    Vec3 out = v;
    const int up = dim - 1;
    out[0] = cosine * v[0] - sine * v[up], out[up] = sine * v[0] + cosine * v[up];
    return out;
  };
  body.radius = box.radius;
  Vec3 half{};
  for (int d = 0; d < dim; ++d) half[d] = std::max(0.0, box.half[d] - box.radius);
  // Along each axis the two ends, and what is between them.
  std::array<std::vector<double>, 3> at;
  for (int d = 0; d < dim; ++d) {
    at[d] = {-1, 1};
    for (const double share : to.between(2 * half[d])) at[d].push_back(2 * share - 1);
  }
  if (dim == 2) at[2] = {0};
  const int most_between = faces ? dim - 1 : dim - 2;
  for (int inner = 0; inner <= most_between; ++inner)  // corners first, then edges, then faces
    for (const double z : at[2])
      for (const double y : at[1])
        for (const double x : at[0]) {
          const Vec3 place{x, y, z};
          Vec3 point{}, inward{};
          int between = 0;
          for (int d = 0; d < dim; ++d) {
            point[d] = place[d] * half[d];
            const bool end = std::abs(place[d]) == 1;
            inward[d] = end ? -place[d] : 0;
            between += !end;
          }
          if (between != inner) continue;
          point = turned(point);
          for (int d = 0; d < dim; ++d) point[d] += box.centre[d];
          to.add(point, turned(inward));
        }
}

/// Way inward at a vertex of a polygon, as far from both edges; nothing at a corner that points inwards.
std::optional<std::array<double, 2>> inward_at(const std::vector<Vertex>& polygon, std::size_t k,
                                               double turn) {
  const std::size_t count = polygon.size();
  const Vertex &a = polygon[(k + count - 1) % count], &b = polygon[k], &c = polygon[(k + 1) % count];
  const auto normal = [&](const Vertex& from, const Vertex& to) {
    const double x = to.x - from.x, z = to.z - from.z, length = std::hypot(x, z);
    return std::array<double, 2>{-turn * z / length, turn * x / length};  // inward
  };
  const auto m = normal(a, b), n = normal(b, c);
  const double corner = turn * ((b.x - a.x) * (c.z - b.z) - (b.z - a.z) * (c.x - b.x));
  if (corner <= 0) return {};
  constexpr double k_most = 3;
  const double scale = std::min(1 / (1 + m[0] * n[0] + m[1] * n[1] + 1e-12),
                                k_most / (std::hypot(m[0] + n[0], m[1] + n[1]) + 1e-12));
  return std::array<double, 2>{scale * (m[0] + n[0]), scale * (m[1] + n[1])};
}

/// Vertices and, of bodies that move, edges of a polygon; in 3D those of both ends of the prism, and its
/// edges along y.
void add_polygon(const SurfaceInput& polygon, int dim, bool faces, SurfacePoints& to) {
  const auto& v = polygon.vertices;
  double twice_area = 0;
  for (std::size_t k = 0; k < v.size(); ++k) {
    const Vertex& next = v[(k + 1) % v.size()];
    twice_area += v[k].x * next.z - next.x * v[k].z;
  }
  const double turn = twice_area < 0 ? -1 : 1;
  std::vector<double> across{0};  // along y, shares of half the width
  if (dim == 3) {
    across = {-1, 1};
    for (const double share : to.between(2 * polygon.half[1])) across.push_back(2 * share - 1);
  }
  const auto add = [&](double x, double z, double y, const std::array<double, 2>& inward) {
    const bool end = std::abs(y) == 1;
    if (dim == 2)
      to.add({x, z, 0}, {inward[0], inward[1], 0});
    else
      to.add({x, polygon.centre[1] + y * polygon.half[1], z}, {inward[0], end ? -y : 0, inward[1]});
  };
  for (const double y : across)
    for (std::size_t k = 0; k < v.size(); ++k) {
      if (const auto inward = inward_at(v, k, turn)) add(v[k].x, v[k].z, y, *inward);
      const Vertex& next = v[(k + 1) % v.size()];
      const double x = next.x - v[k].x, z = next.z - v[k].z, length = std::hypot(x, z);
      if (!(dim == 3 ? std::abs(y) == 1 || faces : faces) || v[k].outside) continue;
      for (const double share : to.between(length))
        add(v[k].x + share * x, v[k].z + share * z, y, {-turn * z / length, turn * x / length});
    }
}

/// Rims of a body that turns about the vertical axis, and its tips.
void add_revolved(const SurfaceInput& body, const Shape& shape, const MeshConfig& mesh, SurfacePoints& to) {
  constexpr int k_least = 16;
  const double middle = (bounds_of(shape, mesh, 3).lower[2] + bounds_of(shape, mesh, 3).upper[2]) / 2;
  for (const Vertex& v : body.vertices) {
    const double z = body.centre[2] + v.z, up = z + mesh.lower[2] < middle ? 1 : -1;
    if (v.x < -1e-9 * mesh.spacing) continue;
    const int count = v.x > 1e-9 * mesh.spacing
                          ? std::max(k_least, static_cast<int>(to.between(2 * M_PI * v.x).size()) + 1)
                          : 1;
    for (int n = 0; n < count; ++n) {
      const double angle = 2 * M_PI * n / count, x = std::cos(angle), y = std::sin(angle), off = count > 1;
      to.add({body.centre[0] + v.x * x, body.centre[1] + v.x * y, z}, {-off * x, -off * y, up});
    }
  }
}

/// The sphere around a body.
void set_reach(const Config& config, const Shape& shape, PairBodyInput& body) {
  const MeshConfig& mesh = config.mesh;
  if (shape.kind == ShapeKind::half_plane || shape.kind == ShapeKind::layer) return;
  Bounds bounds = bounds_of(shape, mesh, config.dim);
  double square = 0;
  for (int d = 0; d < config.dim; ++d) {
    const double slack = k_flush * mesh.spacing;
    // A body that ends on the mesh's boundary goes on beyond it.
    if (bounds.lower[d] < mesh.lower[d] + slack || bounds.upper[d] > mesh.upper[d] - slack) return;
    body.centre[d] = (bounds.lower[d] + bounds.upper[d]) / 2 - mesh.lower[d];
    square += std::pow((bounds.upper[d] - bounds.lower[d]) / 2, 2);
  }
  body.reach = shape.kind == ShapeKind::disc ? shape.radius : std::sqrt(square);
}

PairBodyInput rigid_body(const Config& config, const RigidConfig& rigid) {
  PairBodyInput body;
  const Shape& shape = rigid.shape;
  const MeshConfig& mesh = config.mesh;
  const int dim = config.dim;
  body.dynamic = rigid.motion == Motion::dynamic;
  body.friction = rigid.friction.value_or(-1), body.restitution = rigid.restitution.value_or(-1);
  if (!is_touchable(rigid)) {
    body.reach = -1;
    return body;
  }
  body.surface = surface_input(shape, mesh, dim, Corners::sharp);
  set_reach(config, shape, body);
  const Bounds bounds = bounds_of(shape, mesh, dim);
  double thinnest = HUGE_VAL;
  for (int d = 0; d < dim; ++d) thinnest = std::min(thinnest, bounds.upper[d] - bounds.lower[d]);
  SurfacePoints points(config, std::min(k_inward * mesh.spacing, k_thin * thinnest), body);
  if (body.surface.kind == SurfaceKind::disc) {
    body.ball = true, body.radius = shape.radius;
    body.points.push_back(body.surface.centre), body.inward.push_back({});
  } else if (body.surface.kind == SurfaceKind::box) {
    add_box(body.surface, dim, body.dynamic, points, body);
  } else if (body.surface.kind == SurfaceKind::polygon) {
    add_polygon(body.surface, dim, body.dynamic, points);
  } else if (body.surface.kind == SurfaceKind::revolved) {
    add_revolved(body.surface, shape, mesh, points);
  }
  const Cuts cuts = cuts_of(shape, mesh, dim);
  for (int d = 0; d < dim && body.dynamic; ++d)
    for (int side = 0; side < 2; ++side) {
      const double gap = side == 0 ? bounds.lower[d] - mesh.lower[d] : mesh.upper[d] - bounds.upper[d];
      const bool on = cuts[d][side] || gap < k_flush * mesh.spacing;
      if (!on && !is_open(mesh.walls[d][side])) body.sides |= 1u << (2 * d + side);
    }
  return body;
}

PairBodyInput side_of(const Config& config, int d, int side) {
  PairBodyInput body;
  body.surface.kind = SurfaceKind::half_plane;
  body.surface.normal[d] = side == 0 ? 1 : -1;
  body.surface.centre[d] = side == 0 ? 0 : config.mesh.upper[d] - config.mesh.lower[d];
  const Wall wall = config.mesh.walls[d][side];
  if (wall == Wall::roller) body.friction = 0;
  if (wall == Wall::friction) body.friction = config.mesh.sides[d][side].numbers.friction;
  return body;
}

}  // namespace

PairInput pair_input(const Config& config) {
  PairInput in;
  const auto moves = [](const RigidConfig& rigid) { return rigid.motion == Motion::dynamic; };
  if (!config.rigid_contact || std::none_of(config.rigids.begin(), config.rigids.end(), moves)) return in;
  in.friction = config.rigid_friction.value_or(-1);
  for (const RigidConfig& rigid : config.rigids) in.bodies.push_back(rigid_body(config, rigid));
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side) in.bodies.push_back(side_of(config, d, side));
  return in;
}

}  // namespace mpm
