#include "input/geometry/light_rigids.hpp"

#include <algorithm>

#include "common/revolution.hpp"
#include "input/geometry/mass_properties.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {
namespace {

/// Whether soil all round a body moves with its surface.
bool sticks_to_soil(const RigidConfig& rigid) {
  const bool shears =
      rigid.shear_limit > 0 || rigid.shear_fraction.value_or(0) > 0 || rigid.friction.value_or(0) > 0;
  return !rigid.separates && shears;
}

/// Moment of inertia, about axis k through the middle, of a layer of 1 kg/m2 on the faces of a box of these
/// half edges [kg m2]; half[2] is half a metre in 2D, where the layer is open across z.
double inertia_of_layer(const Vec3& half, int k, int dim) {
  double sum = 0;
  for (int d = 0; d < dim; ++d) {  // the two faces across d
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    double squares = 0;  // mean of the squared distances from the axis
    for (int n = 0; n < 3; ++n)
      if (n != k) squares += half[n] * half[n] * (n == d ? 1 : 1.0 / 3);
    sum += 8 * half[e] * half[f] * squares;
  }
  return sum;
}

/// Smallest ratio of the moments of inertia of a body and of a layer of soil round it. edge [m]: of the
/// bounds of the whole body, of which planes of symmetry leave one of so many parts; mass [kg]: of this part;
/// layer: kg/m2.
double turning_ratio(const Config& config, const RigidConfig& rigid, const Vec3& edge, double parts,
                     double mass, double layer) {
  const auto whole = whole_properties(rigid.shape, config.mesh, config.dim);
  if (!whole) return HUGE_VAL;
  Vec3 half{edge[0] / 2, edge[1] / 2, edge[2] / 2};
  const double filled =
      whole->volume / (edge[0] * edge[1] * edge[2]);  // the layer of a round body is smaller
  double least = HUGE_VAL;
  for (int k = config.dim == 2 ? 2 : 0; k < 3; ++k) {
    const double own = parts * (rigid.inertia ? (*rigid.inertia)[config.dim == 2 ? 0 : k]
                                              : mass / whole->volume * whole->inertia[k]);
    if (rigid.free[3 + k])
      least = std::min(least, own / (filled * layer * inertia_of_layer(half, k, config.dim)));
  }
  return least;
}

}  // namespace

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
  if (rigid.turns() && sticks_to_soil(rigid))
    out.turning = turning_ratio(config, rigid, edge, parts, out.mass, heaviest * config.mesh.spacing);
  return out;
}

bool is_jointed(const Config& config, const RigidConfig& rigid) {
  return std::any_of(config.joints.begin(), config.joints.end(), [&](const JointConfig& joint) {
    return std::any_of(joint.bodies.begin(), joint.bodies.end(),
                       [&](int r) { return r >= 0 && &config.rigids[r] == &rigid; });
  });
}

bool solves_for_velocity(const Config& config, const RigidConfig& rigid) {
  return !rigid.contact_at_sites && !rigid.is_sprung() && !is_jointed(config, rigid) &&
         lightness_of(config, rigid).is_light();
}

}  // namespace mpm
