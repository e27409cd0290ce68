// Checks of the other options in a mesh with periodic sides.

#include <algorithm>
#include <cmath>

#include "common/text.hpp"
#include "input/geometry/height_surface.hpp"
#include "input/geometry/mass_properties.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr double k_slack = 1e-6;  // cells
constexpr double k_reach = 2;     // cells, further than a rigid acts on soil

/// The option that makes a rigid move along a direction; empty where it does not.
std::string moving_option(const RigidConfig& rigid, int d) {
  if (rigid.motion == Motion::dynamic && rigid.free[d]) return rigid.name + "_motion";
  if (rigid.motion == Motion::fixed || rigid.velocity[d] == 0) return "";
  return rigid.name + (rigid.displacement_table ? "_displacement_table"
                       : rigid.velocity_table   ? "_velocity_table"
                                                : "_velocity");
}

/// Whether a shape has the same section everywhere along direction d.
bool goes_through(const Shape& shape, const MeshConfig& mesh, int dim, int d) {
  const double slack = k_slack * mesh.spacing;
  const auto spans = [&](double low, double high) {
    return low <= mesh.lower[d] + slack && high >= mesh.upper[d] - slack;
  };
  switch (shape.kind) {
    case ShapeKind::half_plane: return shape.normal[d] == 0;
    case ShapeKind::box: return shape.angle == 0 && spans(shape.lower[d], shape.upper[d]);
    case ShapeKind::polygon: return dim == 3 && d == 1 && spans(shape.width[0], shape.width[1]);
    case ShapeKind::layer:
      return d < dim - 1 && shape.top->is_level() && (!shape.base || shape.base->is_level());
    case ShapeKind::parts:
      return std::all_of(shape.parts.begin(), shape.parts.end(),
                         [&](const Shape& part) { return goes_through(part, mesh, dim, d); });
    default: return false;
  }
}

/// Whether a rigid turns about another axis than d, so that its rotation moves its ends along d.
bool turns_across(const RigidConfig& rigid, int dim, int d) {
  if (dim == 2 || rigid.turns_in_run) return rigid.turns();
  for (int k = 0; k < 3; ++k) {
    const bool turns = rigid.motion == Motion::dynamic ? rigid.free[3 + k] : rigid.angular_velocity[k] != 0;
    if (k != d && turns) return true;
  }
  return false;
}

void reject_rotation(OptionReader& in, const RigidConfig& rigid, const std::string& why) {
  const bool dynamic = rigid.motion == Motion::dynamic;
  in.reject(rigid.name + (dynamic ? "_free" : "_angular_velocity"),
            (dynamic ? "no rotation of a rigid that " : "0 of a rigid that ") + why);
}

/// Checks that a turning rigid stays away from the sides, however far it has turned.
void check_circle(OptionReader& in, const Config& config, const RigidConfig& rigid, int d,
                  const std::string& where) {
  const MeshConfig& mesh = config.mesh;
  const Bounds bounds = bounds_of(rigid.shape, mesh, config.dim);
  const auto whole = whole_properties(rigid.shape, mesh, config.dim);
  Vec3 centre{};
  double squares = 0;
  for (int e = 0; e < config.dim; ++e) {
    centre[e] = rigid.centre_of_mass ? (*rigid.centre_of_mass)[e]
                : whole              ? whole->centre[e]
                                     : (bounds.lower[e] + bounds.upper[e]) / 2;
    const double far = std::max(centre[e] - bounds.lower[e], bounds.upper[e] - centre[e]);
    squares += far * far;
  }
  if (rigid.shape.kind == ShapeKind::disc && !rigid.centre_of_mass)
    squares = rigid.shape.radius * rigid.shape.radius;
  const double free = std::min(centre[d] - mesh.lower[d], mesh.upper[d] - centre[d]) - std::sqrt(squares);
  if (free >= (k_reach - k_slack) * mesh.spacing) return;
  reject_rotation(in, rigid, "comes within 2 cells of a side as it turns" + where);
}

void check_rigid(OptionReader& in, const Config& config, const RigidConfig& rigid, int d) {
  const MeshConfig& mesh = config.mesh;
  const std::string along = std::string(" along ") + "xyz"[d], moving = moving_option(rigid, d),
                    where = ", where -" + side_option(d, 0) + " is periodic";
  if (goes_through(rigid.shape, mesh, config.dim, d)) {
    if (rigid.turns()) reject_rotation(in, rigid, "goes through the mesh" + along + where);
    if (!moving.empty() && rigid.contact_normal == ContactNormal::gradient)
      in.reject(rigid.name + "_contact_normal", "surface of a rigid that moves" + along + where);
    return;
  }
  if (!moving.empty())
    return in.reject(moving, moving == rigid.name + "_motion"
                                 ? "fixed, or a -" + rigid.name + "_free without " + "xyz"[d] +
                                       " beside it, for a rigid that has ends" + along + where
                                 : "no motion" + along + " of a rigid that has ends there" + where);
  const Bounds bounds = bounds_of(rigid.shape, mesh, config.dim);
  const double least = (k_reach - k_slack) * mesh.spacing;
  if (bounds.lower[d] - mesh.lower[d] < least || mesh.upper[d] - bounds.upper[d] < least)
    in.reject(rigid.name + "_shape", "a box, half plane, level layer or prism that goes through the mesh" +
                                         along + ", or a shape 2 cells away from the sides" + where);
  else if (turns_across(rigid, config.dim, d))
    check_circle(in, config, rigid, d, where);
}

}  // namespace

void check_periodic(OptionReader& in, const Config& config) {
  if (in.listing()) return;
  for (int d = 0; d < config.dim; ++d) {
    if (!is_periodic(config.mesh, d)) continue;
    const std::string where = ", where -" + side_option(d, 0) + " is periodic";
    if (config.water.level && config.gravity[d] != 0)
      in.reject("water_level", std::string("a -gravity of 0 along ") + "xyz"[d] + where);
    for (const BodyConfig& body : config.bodies)
      if (body.k0 && d == config.dim - 1)
        in.reject(body.name + "_stress", "numbers" + where + ": such ground has no surface");
    for (const RigidConfig& rigid : config.rigids) check_rigid(in, config, rigid, d);
  }
}

void check_periodic_kept(OptionReader& in, int dim, const MeshConfig& first, const MeshConfig& mesh) {
  for (int d = 0; d < dim; ++d)
    if (is_periodic(first, d) != is_periodic(mesh, d))
      in.reject(side_option(d, 0), is_periodic(first, d)
                                       ? "periodic, as in the first stage"
                                       : "a kind of side other than periodic, as in the first stage");
}

}  // namespace mpm
