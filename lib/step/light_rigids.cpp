#include "step/light_rigids.hpp"

#include <algorithm>

#include "common/revolution.hpp"
#include "input/geometry/mass_properties.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {

Lightness lightness_of(const Config& config, const RigidConfig& rigid) {
  Lightness out;
  if (rigid.motion != Motion::dynamic || rigid.absent) return out;
  const Bounds bounds = within(bounds_of(rigid.shape, config.mesh, config.dim), config.mesh, config.dim);
  const Cuts cuts = cuts_of(rigid.shape, config.mesh, config.dim);
  Vec3 edge{1, 1, 1};  // m
  // Planes of symmetry leave one of so many parts of a body, which is as light as the whole.
  double parts = 1;
  for (int d = 0; d < config.dim; ++d) {
    const double images = cuts[d][0] || cuts[d][1] ? 2 : 1;
    edge[d] = images * (bounds.upper[d] - bounds.lower[d]);
    parts *= images;
  }
  const double middle = (bounds.lower[0] + bounds.upper[0]) / 2, ring = revolved_length(config, middle);
  out.mass = mass_of(config, rigid);
  double face = 0, heaviest = 0;  // m2 (m in 2D), kg/m3
  for (int d = 0; d < config.dim; ++d) {
    // A body of revolution moves along the axis alone.
    const bool radial = config.geometry == Geometry::axisymmetric && d == 0;
    if (radial || !(rigid.free[d] || rigid.turns())) continue;
    double area = d == 0 ? revolved_length(config, bounds.upper[0]) : ring;
    for (int k = 0; k < config.dim; ++k) area *= k == d ? 1 : edge[k];
    face = std::max(face, area);
  }
  for (const BodyConfig& body : config.bodies) heaviest = std::max(heaviest, density_of(config, body));
  out.layer = heaviest * face * config.mesh.spacing / parts;
  return out;
}

bool solves_for_velocity(const Config& config, const RigidConfig& rigid) {
  if (rigid.contact_at_sites || rigid.is_sprung() || !lightness_of(config, rigid).is_light()) return false;
  return std::none_of(config.joints.begin(), config.joints.end(), [&](const JointConfig& joint) {
    return std::any_of(joint.bodies.begin(), joint.bodies.end(),
                       [&](int r) { return r >= 0 && &config.rigids[r] == &rigid; });
  });
}

}  // namespace mpm
