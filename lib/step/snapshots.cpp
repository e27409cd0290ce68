#include "step/snapshots.hpp"

#include <algorithm>

#include "base/copy.hpp"
#include "common/material_table.hpp"
#include "common/text.hpp"
#include "functions/grid_velocity.hpp"
#include "input/geometry/triangle_surface.hpp"
#include "output/frame_surface.hpp"
#include "parallel/gather.hpp"
#include "rebuild/batches.hpp"
#include "step/load_input.hpp"
#include "step/water.hpp"
#include "transfer/download_nodes.hpp"

namespace mpm {
namespace {

/// Particles [from, to) of the soil on the host: those of a body.
struct Rows {
  const SoilFields& soil;
  std::size_t from, to;

  std::size_t count() const { return to - from; }
  std::vector<double> of(const std::vector<double>& column) const {
    return {column.begin() + static_cast<long>(from), column.begin() + static_cast<long>(to)};
  }
};

/// The state variables of a body that frames have, and of the parameters of which its particles have own
/// values (own_parameters), these. Every body has a plastic strain there, so that pictures of all bodies may
/// show it: zero where the law has none.
std::vector<StateField> state_fields(const std::vector<StateVariable>& variables,
                                     const std::vector<std::string>& own_parameters, const Rows& rows) {
  std::vector<StateField> fields;
  bool has_plastic_strain = false;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const StateVariable& variable = variables[k];
    const bool own = variable.parameter != nullptr && std::find(own_parameters.begin(), own_parameters.end(),
                                                                variable.parameter) != own_parameters.end();
    if (!variable.output && !own) continue;
    fields.push_back({own ? variable.parameter : variable.name, rows.of(rows.soil.history[k])});
    has_plastic_strain = has_plastic_strain || fields.back().name == "plastic_strain";
  }
  if (!has_plastic_strain) fields.push_back({"plastic_strain", std::vector<double>(rows.count())});
  return fields;
}

/// The columns of a body that frames have.
template <int Dim>
void frame_columns(const Rows& rows, ParticleSnapshot* body) {
  for (const ParticleColumn& column : k_particle_columns) {
    const std::vector<double>& values = rows.soil.*column.values;
    if (column.framed == Framed::no || values.empty()) continue;
    const int n = width_of(column.width, Dim, 0), wide = framed_width(column.width);
    std::vector<double>& framed = body->*column.values;
    framed.assign(wide * rows.count(), 0);
    for (std::size_t p = rows.from; p < rows.to; ++p)
      for (int k = 0; k < n; ++k)
        framed[(p - rows.from) * wide + framed_place(column.width, Dim, k)] = values[p * n + k];
  }
}

/// Where frames have pore pressures: adds those of a body to its fields, and makes its stress total. `pore`:
/// column of the excess pressure, -1 where there is none.
template <int Dim>
void add_pore_pressures(const Config& config, const Rows& rows, int pore, ParticleSnapshot* body) {
  const Water<Dim> water = water_of<Dim>(config);
  std::vector<double> excess(rows.count()), total(rows.count());
  for (std::size_t n = 0; n < rows.count(); ++n) {
    Vector<double, Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = rows.soil.position[(rows.from + n) * Dim + d];
    const double hydrostatic = water.is_there() ? water.pressure(x) : 0.0;
    if (pore >= 0) excess[n] = rows.soil.history[pore][rows.from + n];
    total[n] = hydrostatic + excess[n];
    for (int k = 0; k < 3; ++k) body->stress[6 * n + k] -= hydrostatic;
  }
  body->state.push_back({"pore_pressure", std::move(total)});
  if (pore >= 0) body->state.push_back({k_excess_pore_pressure, std::move(excess)});
}

/// Adds the porosity of a body's soil, 0 where no water flows in its pores.
void add_porosity(const Rows& rows, ParticleSnapshot* body) {
  StateField porosity{"porosity", std::vector<double>(rows.count())};
  for (std::size_t n = 0; n < rows.count(); ++n)
    if (const double solid = rows.soil.solid_volume[rows.from + n]; solid > 0)
      porosity.values[n] = 1 - solid / rows.soil.volume[rows.from + n];
  body->state.push_back(std::move(porosity));
}

/// Adds component d of a vector of the soil [Dim N] to a body's fields.
template <int Dim>
void add_component(const std::string& name, int d, const std::vector<double>& values, const Rows& rows,
                   ParticleSnapshot* body) {
  StateField field{name + "_" + "xyz" [d], {}};
  for (std::size_t p = rows.from; p < rows.to; ++p) field.values.push_back(values[p * Dim + d]);
  body->state.push_back(std::move(field));
}

/// Adds the triangles of a shape and its parts, where they are in a pose. lower [m]: corner of the mesh.
template <int Dim>
void add_triangles(const Shape& shape, const RigidPose<Dim>& pose, const Vec3& lower, ParticleSnapshot* to) {
  for (const Shape& part : shape.parts) add_triangles(part, pose, lower, to);
  if (shape.kind != ShapeKind::stl) return;
  const TriangleSurface& surface = *shape.triangles;
  const int before = static_cast<int>(to->vertices.size() / 3);
  for (int v = 0; v < surface.vertices(); ++v) {
    Vector<double, Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = surface.vertex(v)[d] - lower[d];
    x = pose.to_world(x);
    for (int d = 0; d < Dim; ++d) to->vertices.push_back(x[d] + lower[d]);
  }
  for (int k = 0; k < surface.size(); ++k)
    for (const int v : surface.triangle(k)) to->triangles.push_back(before + v);
}

/// Whether a body or rigid has a name.
bool is_name(const Config& config, const std::string& name) {
  const auto is = [&](const auto& thing) { return thing.name == name; };
  return std::any_of(config.bodies.begin(), config.bodies.end(), is) ||
         std::any_of(config.rigids.begin(), config.rigids.end(), is);
}

/// Vectors with three components, positions from the origin.
template <int Dim>
ParticleSnapshot node_snapshot(NodeFields&& nodes, const Vec3& lower) {
  ParticleSnapshot out;
  out.name = k_nodes;
  out.position.assign(3 * nodes.mass.size(), 0);
  out.velocity = out.position;
  for (std::size_t n = 0; n < nodes.mass.size(); ++n)
    for (int d = 0; d < Dim; ++d) {
      out.position[3 * n + d] = nodes.position[n * Dim + d] + lower[d];
      out.velocity[3 * n + d] = nodes.velocity[n * Dim + d];
    }
  out.mass = std::move(nodes.mass), out.number = std::move(nodes.number);
  return out;
}

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode Snapshots<Space, T, Dim>::keep_heights(std::vector<BodyParticles>* bodies) {
  PetscFunctionBeginUser;
  std::vector<long> id;
  std::vector<double> height;
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    BodyParticles& body = (*bodies)[b];
    if (body.reference_height.empty())
      for (std::size_t p = 0; p < body.position.size() / Dim; ++p)
        body.reference_height.push_back(body.position[p * Dim + Dim - 1] + run_.config.mesh.lower[Dim - 1]);
    height.insert(height.end(), body.reference_height.begin(), body.reference_height.end());
    for (long p = 0; p < static_cast<long>(body.reference_height.size()); ++p)
      id.push_back(body.id.empty() ? ids_.first(b) + p : body.id[p]);
  }
  PetscCall(heights_.keep(run_.comm, ids_.at_start(), id, height));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
ParticleSnapshot Snapshots<Space, T, Dim>::body_of(std::size_t b, const SoilFields& soil,
                                                   const std::vector<double>& grid_velocity) const {
  const Config& config = run_.config;
  const auto& points = run_.state.soil.points;
  const Rows rows{soil, soil.first[b], soil.first[b + 1]};
  ParticleSnapshot body;
  body.name = config.bodies[b].name;
  frame_columns<Dim>(rows, &body);
  body.grid_velocity.assign(3 * rows.count(), 0);
  for (std::size_t n = 0; n < rows.count(); ++n)
    for (int d = 0; d < Dim; ++d) {
      body.position[3 * n + d] += config.mesh.lower[d];
      body.grid_velocity[3 * n + d] = grid_velocity[(rows.from + n) * Dim + d];
    }
  const auto variables = state_variables(config.materials[config.bodies[b].material]);
  body.own_names = given_parameters(config.bodies[b], variables);
  body.state = state_fields(variables, body.own_names, rows);
  if (has_pore_pressure(config))  // of all bodies, so that pictures may show them
    add_pore_pressures<Dim>(config, rows, points.history.pore, &body);
  body.has_flow = points.has_flow;
  if (points.has_flow) add_porosity(rows, &body);
  for (int d = 0; d < Dim; ++d)
    if (is_periodic(config.mesh, d)) add_component<Dim>("periods", d, soil.periods, rows, &body);
  for (int d = 0; d < Dim && points.face_count > 0; ++d)
    add_component<Dim>("load_area", d, soil.load_area, rows, &body);
  for (int d = 0; d < Dim && points.has_domain; ++d)
    add_component<Dim>("half_length", d, soil.half_length, rows, &body);
  return body;
}

template <class Space, class T, int Dim>
std::vector<ParticleSnapshot> Snapshots<Space, T, Dim>::rigids_at(double time) const {
  const Config& config = run_.config;
  std::vector<ParticleSnapshot> groups;
  const auto rigids = mirror_of(run_.state.rigids);
  for (std::size_t r = 0; r < config.rigids.size(); ++r) {
    const std::vector<double> position = download_rigid_positions(run_.state, static_cast<int>(r));
    ParticleSnapshot rigid;
    rigid.name = config.rigids[r].name;
    rigid.position.assign(3 * (position.size() / Dim), 0);
    rigid.velocity = rigid.position;
    RigidMotion<Dim> motion = rigids(r).motion;
    for (int d = 0; d < Dim; ++d)
      motion.velocity[d] = velocity_at(config.rigids[r], d, motion.velocity[d], time);
    for (std::size_t p = 0; p < position.size() / Dim; ++p) {
      const double* const x = &position[p * Dim];
      const Vector<double, Dim> v = motion.velocity_at([x](int d) { return x[d]; });
      for (int d = 0; d < Dim; ++d) {
        rigid.position[3 * p + d] = x[d] + config.mesh.lower[d];
        rigid.velocity[3 * p + d] = v[d];
      }
    }
    if (!is_name(config, surface_group(rigid.name)))
      add_triangles(config.rigids[r].shape, motion.pose, config.mesh.lower, &rigid);
    groups.push_back(std::move(rigid));
  }
  run_.rigids.widen(groups);
  return groups;
}

template <class Space, class T, int Dim>
PetscErrorCode Snapshots<Space, T, Dim>::take(Snapshot* out) const {
  PetscFunctionBeginUser;
  auto& s = run_.state;
  collect_soil(s);
  const SoilFields soil = download_soil(s);
  PetscCall(run_.sum_soil());
  const std::vector<double> grid_velocity = grid_velocities(s, order_for_host(s));
  const bool splits = s.soil.points.splits;
  std::vector<long> created(soil.id.begin(), soil.id.end());
  if (splits) created.assign(soil.ancestor.begin(), soil.ancestor.end());
  std::vector<double> height;
  PetscCall(heights_.look_up(created, &height));
  out->dim = Dim;
  out->bodies.clear(), out->nodes.clear();
  for (std::size_t b = 0; b < run_.config.bodies.size(); ++b) {
    const Rows rows{soil, soil.first[b], soil.first[b + 1]};
    ParticleSnapshot body = body_of(b, soil, grid_velocity);
    body.reference_height = rows.of(height);
    // Particles that were split have numbers of their own, whatever their body.
    const long first = splits ? 0 : ids_.first(b), last = splits ? ids_.given() : ids_.end(b);
    for (std::size_t p = rows.from; p < rows.to && run_.ranks; ++p)
      body.id.push_back(soil.id[p] - static_cast<int>(first));
    if (run_.ranks) PetscCall(order_particles(run_.comm, last - first, &body));
    out->bodies.push_back(std::move(body));
  }
  out->rigids = rigids_at(out->time - run_.config.time.start);
  if (run_.config.output.nodes) {
    out->nodes = {node_snapshot<Dim>(download_nodes(s), run_.config.mesh.lower)};
    if (run_.ranks) PetscCall(gather_nodes(run_.comm, &out->nodes[0]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Snapshots<Space, T, Dim>::save_for_starts(SavedState* saved) const {
  PetscFunctionBeginUser;
  SavedField height{"reference_height", 1, sizeof(double), {}};
  std::vector<long> created = saved->soil.id;
  for (const SavedField& field : saved->soil.fields)
    if (field.name == "ancestor") created.assign(field.values.begin(), field.values.end());
  PetscCall(heights_.look_up(created, &height.values));
  const auto& soil = run_.state.soil.points;
  if (!soil.has_own_mass) {  // else it is there
    const auto bodies = mirror_of(soil.bodies);
    SavedField mass{"mass", 1, sizeof(T), {}};
    for (const SavedField& field : saved->soil.fields)
      if (field.name == "body")
        for (const double b : field.values) mass.values.push_back(bodies(static_cast<int>(b)).mass);
    saved->soil.fields.push_back(std::move(mass));
  }
  saved->soil.fields.push_back(std::move(height));
  saved->columns.assign(soil.history.name.data(), soil.history.name.data() + soil.history.columns);
  saved->variables.clear();
  for (const BodyConfig& body : run_.config.bodies) {
    std::vector<std::string> names;
    for (const StateVariable& variable : state_variables(run_.config.materials[body.material]))
      names.emplace_back(variable.name);
    saved->variables.push_back(join(names));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim) template class Snapshots<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
