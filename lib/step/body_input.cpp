#include "step/body_input.hpp"

#include <algorithm>
#include <limits>

#include "common/f_bar.hpp"
#include "common/material_table.hpp"
#include "common/revolution.hpp"
#include "common/velocity_fields.hpp"
#include "input/geometry/light_rigids.hpp"
#include "input/geometry/shapes.hpp"
#include "physics/materials/any.hpp"
#include "step/rigid_inertia.hpp"
#include "step/surface_input.hpp"
#include "step/water.hpp"

namespace mpm {
namespace {

/// The state variables of the particles of a body: those of their creation, but for those that a law changes
/// and a file gives. Own parameters that a field or a file gives are the particles'. Behind them comes the
/// excess pore pressure, where it is given.
template <int Dim>
std::vector<StateField> start_state(const Config& config, const AnyMaterial<double>& law,
                                    ParticleColumns& in) {
  const auto variables = state_variables(law);
  const std::size_t count = in.position.size() / Dim;
  std::vector<StateField> state;
  for (const StateVariable& variable : variables)
    state.push_back({variable.name, std::vector<double>(count)});
  ParticleStart start;
  start.up = Dim - 1;
  std::array<const StateField*, k_most_own> own{};
  const auto keys = own_parameters(variables);
  for (const StateField& given : in.own_parameters)
    if (const auto key = std::find(keys.begin(), keys.end(), given.name); key != keys.end())
      own[key - keys.begin()] = &given;
  for (std::size_t p = 0; p < count && !variables.empty(); ++p) {
    start.height = in.reference_height[p];
    for (std::size_t k = 0; k < own.size(); ++k)
      if (own[k] != nullptr) start.own[k] = own[k]->values[p];
    for (int d = 0; d < Dim; ++d) start.position[d] = in.position[p * Dim + d] + config.mesh.lower[d];
    for (int k = 0; k < sym_size<Dim> && !in.stress.empty(); ++k)
      start.stress[k] = in.stress[p * sym_size<Dim> + k];
    const auto values = initial_state(law, start);
    for (std::size_t k = 0; k < values.size(); ++k) state[k].values[p] = values[k];
  }
  for (StateField& given : in.state)
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (variables[k].changes && given.name == variables[k].name) state[k].values = std::move(given.values);
  for (StateField& given : in.state)
    if (given.name == k_excess_pore_pressure) state.push_back(std::move(given));
  return state;
}

/// Makes the stress of a body total, after its state was made of the effective one.
template <int Dim>
void add_excess_pressure(ParticleColumns& in) {
  if (in.state.empty() || in.state.back().name != k_excess_pore_pressure) return;
  const std::vector<double>& excess = in.state.back().values;
  in.stress.resize(excess.size() * sym_size<Dim>);
  for (std::size_t p = 0; p < excess.size(); ++p)
    for (int k = 0; k < 3; ++k) in.stress[p * sym_size<Dim> + k] -= excess[p];
}

/// Pore pressure that the options give a body, in excess of the hydrostatic one, and the volumes of its
/// grains, where nothing has given them.
template <int Dim>
void begin_pores(const Config& config, const BodyConfig& body, BodyInput& in) {
  const MaterialConfig& material = config.materials[body.material];
  const std::size_t count = in.position.size() / Dim;
  const bool given = !in.state.empty() && in.state.back().name == k_excess_pore_pressure;
  if (material.has_pore_pressure() && !given && body.pore_pressure) {
    const Water<Dim> water = water_of<Dim>(config);
    StateField excess{k_excess_pore_pressure, std::vector<double>(count, *body.pore_pressure)};
    for (std::size_t p = 0; p < count && water.is_there(); ++p) {
      Vector<double, Dim> x;
      for (int d = 0; d < Dim; ++d) x[d] = in.position[p * Dim + d];
      excess.values[p] -= water.pressure(x);
    }
    in.state.push_back(std::move(excess));
  }
  if (!material.saturated()) in.solid_volume.clear(), in.darcy_flux.clear();
  if (!material.saturated() || !in.solid_volume.empty()) return;
  for (std::size_t p = 0; p < count; ++p)
    in.solid_volume.push_back((1 - material.pores.porosity) *
                              (in.volume.empty() ? in.particle_volume : in.volume[p]));
}

template <int Dim>
BodyInput body_input(const Config& config, const BodyConfig& body, BodyParticles&& particles) {
  const MaterialConfig& material = config.materials[body.material];
  const AnyMaterial<double> law =
      make_material<double>(model_index(material.model), material.parameters, material.object.get());
  BodyInput in{{std::move(static_cast<ParticleColumns&>(particles))}, std::move(particles.id)};
  in.common_velocity = body.velocity;
  in.particle_volume = particles.particle_volume;
  in.least_volume = particles.least_volume, in.most_volume = particles.most_volume;
  in.particle_mass = particles.particle_mass, in.least_mass = particles.least_mass;
  in.half_length = particles.spacing / config.mesh.spacing / 2;
  in.density = density_of(config, body);
  in.weighed = body.shape.kind != ShapeKind::particles;
  in.material = body.material;
  if (in.stress.empty() && body.stress != Sym6{})
    for (std::size_t p = 0; p < in.position.size() / Dim; ++p)
      in.stress.insert(in.stress.end(), body.stress.begin(), body.stress.begin() + sym_size<Dim>);
  in.state = start_state<Dim>(config, law, in);
  begin_pores<Dim>(config, body, in);
  add_excess_pressure<Dim>(in);
  return in;
}

/// Mass of the water that a rigid displaces where it begins [kg].
template <int Dim>
double displaced_mass(const Config& config, const RigidInput& rigid) {
  const Water<Dim> water = water_of<Dim>(config);
  double volume = 0;
  for (std::size_t p = 0; p < rigid.position.size() / Dim && water.is_there(); ++p) {
    Vector<double, Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = rigid.position[p * Dim + d];
    volume += rigid.particle_volume * revolved_length(config, x[0]) *
              water.submerged_share(x, filled<double, Dim>(rigid.half_length * config.mesh.spacing));
  }
  return water.density * volume;
}

/// Mass of a rigid body less that of the water it displaces [kg].
double carried_mass(const Config& config, const RigidInput& in) {
  const double mass = config.geometry == Geometry::axisymmetric
                          ? in.density * in.revolved_volume
                          : in.density * in.particle_volume * (in.position.size() / config.dim);
  return mass - (config.dim == 2 ? displaced_mass<2>(config, in) : displaced_mass<3>(config, in));
}

void set_contact(const Config& config, const RigidConfig& rigid, RigidInput* in) {
  const bool only_friction = rigid.friction && !rigid.has_shear_limit && !rigid.shear_fraction;
  in->shear_limit = only_friction ? std::numeric_limits<double>::infinity() : rigid.shear_limit;
  in->shear_fraction = rigid.shear_fraction.value_or(-1);
  in->friction = rigid.friction.value_or(-1);
  in->permeable = rigid.permeable;
  in->surface = surface_input(rigid.shape, config.mesh, config.dim);
  for (const Shape& part : rigid.shape.parts)
    in->parts.push_back(part.kind == ShapeKind::stl
                            ? SurfaceInput{.kind = SurfaceKind::sampled}
                            : surface_input(part, config.mesh, config.dim, Corners::sharp));
  in->part_forces = rigid.part_forces;
  in->surface_normal = rigid.contact_normal == ContactNormal::surface;
  in->separates = rigid.separates;
  in->at_sites = rigid.contact_at_sites;
  if (rigid.contact_gap_scaling) in->reach = rigid.contact_gap_reach * config.mesh.spacing;
  in->exponent = rigid.contact_gap_exponent;
}

RigidInput rigid_input(const Config& config, const RigidConfig& rigid, BodyParticles&& particles) {
  RigidInput in;
  in.position = std::move(particles.position);
  in.particle_volume = particles.particle_volume;
  if (config.geometry == Geometry::axisymmetric)
    for (std::size_t p = 0; p < in.position.size(); p += config.dim)
      in.revolved_volume += in.particle_volume * revolved_length(config, in.position[p]);
  in.half_length = particles.spacing / config.mesh.spacing / 2;
  in.dynamic = rigid.motion == Motion::dynamic;
  const double volume = in.particle_volume * static_cast<double>(in.position.size() / config.dim);
  const double whole = in.revolved_volume > 0 ? in.revolved_volume : volume;
  if (in.dynamic) in.density = rigid.mass && whole > 0 ? *rigid.mass / whole : rigid.density;
  if (rigid.motion != Motion::fixed) in.velocity = rigid.velocity;
  const double carried = carried_mass(config, in);
  for (int d = 0; d < 3; ++d) in.force[d] = rigid.force[d] + carried * config.gravity[d];
  in.timed = rigid.velocity_table || rigid.displacement_table;
  const Cuts cuts = cuts_of(rigid.shape, config.mesh, config.dim);
  for (int d = 0; d < config.dim; ++d) in.held[d] = cuts[d][0] || cuts[d][1];
  if (config.geometry == Geometry::axisymmetric) in.held[0] = true;
  for (int d = 0; d < config.dim; ++d) in.held[d] = in.held[d] || (in.dynamic && !rigid.free[d]);
  in.turning = turning_of(config, rigid, in);
  in.light = solves_for_velocity(config, rigid);
  set_contact(config, rigid, &in);
  return in;
}

}  // namespace

std::vector<MaterialInput> material_input(const Config& config) {
  const double f_bar = f_bar_range(config).largest;
  std::vector<MaterialInput> materials;
  for (const auto& m : config.materials)
    materials.push_back({model_index(m.model), m.parameters, m.object, m.pore_stiffness,
                         f_bar > 0 ? f_bar_fraction(config, m) / f_bar : 1.0, m.saturated()});
  return materials;
}

std::vector<double> shear_ratios(const Config& config) {
  std::vector<double> ratios;
  for (const MaterialConfig& material : config.materials)
    ratios.push_back(shear_wave_ratio(material).value_or(0));
  return ratios;
}

template <int Dim>
std::vector<BodyInput> body_input(const Config& config, std::vector<BodyParticles>& particles) {
  std::vector<BodyInput> bodies;
  const VelocityFields fields = velocity_fields(config);
  for (std::size_t b = 0; b < particles.size(); ++b) {
    bodies.push_back(body_input<Dim>(config, config.bodies[b], std::move(particles[b])));
    bodies.back().velocity_field = fields.of_body[b];
  }
  return bodies;
}

std::vector<RigidInput> rigid_input(const Config& config, std::vector<BodyParticles>& particles) {
  std::vector<RigidInput> rigids;
  for (std::size_t r = 0; r < particles.size(); ++r)
    rigids.push_back(rigid_input(config, config.rigids[r], std::move(particles[r])));
  return rigids;
}

std::vector<double> carried_masses(const Config& config, const std::vector<RigidInput>& rigids) {
  std::vector<double> masses;
  for (const RigidInput& rigid : rigids) masses.push_back(carried_mass(config, rigid));
  return masses;
}

template std::vector<BodyInput> body_input<2>(const Config&, std::vector<BodyParticles>&);
template std::vector<BodyInput> body_input<3>(const Config&, std::vector<BodyParticles>&);

}  // namespace mpm
