#include "step/pair_input.hpp"

#include <algorithm>
#include <cmath>

#include "common/rigid_contact.hpp"
#include "input/geometry/shapes.hpp"
#include "step/surface_input.hpp"
#include "step/surface_points.hpp"

namespace mpm {
namespace {

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
  body.ball = body.surface.kind == SurfaceKind::disc;
  body.points = surface_points(config, shape, body.dynamic);
  const Bounds bounds = bounds_of(shape, mesh, dim);
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
