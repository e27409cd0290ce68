#include "transfer/upload.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/copy.hpp"
#include "functions/follow_soil.hpp"
#include "physics/domain.hpp"
#include "physics/materials/any.hpp"
#include "physics/pore_water.hpp"
#include "physics/stretch_domain.hpp"
#include "physics/surface.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/shift_particle.hpp"
#include "transfer/velocity_gradients.hpp"

namespace mpm {
namespace {

/// A view filled from the host. It is made anew unless it has its memory already.
template <class View, class Get>
void fill_view(View& view, const std::string& label, int count, Get&& get) {
  if (static_cast<int>(view.extent(0)) != count)
    view = View(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), count);
  auto host = Kokkos::create_mirror_view(view);
  for (int p = 0; p < count; ++p) host(p) = get(p);
  copy(view, host);
}

/// Cell and coordinate in it of positions [m from the mesh's lower corner]; those outside the mesh are a
/// fault, but on a periodic side, which is the opposite one. field_of(p): velocity field of point p.
template <class Space, class T, int Dim, class Points_, class Field>
void place_points(const Grid<T, Dim>& grid, double spacing, const std::vector<double>& position,
                  const Field& field_of, ParticleSet<Space, Points_>& set, Fault& fault) {
  const int count = set.points.all = set.points.count;
  std::vector<long> address(count);
  std::vector<Vector<T, Dim>> coordinate(count);
  for (int p = 0; p < count; ++p) {
    Coord<Dim> c{};
    for (int d = 0; d < Dim; ++d) {
      const double x = position[std::size_t(p) * Dim + d] / spacing;
      c[d] = static_cast<int>(std::floor(x));
      coordinate[p][d] = static_cast<T>(x - c[d]);
      if (coordinate[p][d] >= 1) coordinate[p][d] = 0, ++c[d];  // 1 - tiny rounds to 1 in T
      c[d] = grid.in_period(d, c[d]);
    }
    if (!grid.holds(c) && fault.kind == FaultKind::none) {
      fault.kind = FaultKind::outside;
      fault.particle = p;
      for (int d = 0; d < Dim; ++d) fault.position[d] = position[std::size_t(p) * Dim + d];
    }
    address[p] = grid.holds(c) ? grid.address_of(c, field_of(p)) : 0;
  }
  fill_view(set.address, "mpm::address", count, [&](int p) { return address[p]; });
  fill_view(set.points.coordinate, "mpm::coordinate", count, [&](int p) { return coordinate[p]; });
  fill_view(set.points.id, "mpm::id", count, [](int p) { return p; });
  fill_view(set.points.cell, "mpm::cell", count, [](int) { return 0; });
}

/// Mass of each particle of a body whose particles have none of their own [kg].
double common_mass(const BodyInput& body) {
  return body.particle_mass > 0 ? body.particle_mass : body.density * body.particle_volume;
}

/// Bytes of scratch memory that sorting the rigid with the most points takes.
template <class Space, class T, int Dim>
std::size_t scratch_of_rigids(const std::vector<RigidInput>& rigids) {
  RigidPoints<Space, T, Dim> points;
  std::size_t most = 0;
  for (const RigidInput& rigid : rigids) most = std::max(most, rigid.position.size() / Dim);
  return most * scratch_of_point(points);
}

/// As many columns as the materials of the bodies need, and their names: those of the variables where the
/// laws agree.
template <class Space, class T>
void name_columns(History<Space, T>& history, const std::vector<MaterialInput>& materials,
                  const std::vector<BodyInput>& bodies) {
  static const auto shared = [] {
    std::array<std::string, k_most_state<Space>> names;
    for (std::size_t k = 0; k < names.size(); ++k) names[k] = "column_" + std::to_string(k);
    return names;
  }();
  history.columns = 0;
  for (const BodyInput& body : bodies) {
    const MaterialInput& material = materials[body.material];
    const auto variables = state_variables(material.model, material.parameters);
    for (int k = 0; k < static_cast<int>(variables.size()); ++k) {
      const bool first = k >= history.columns;
      const std::string name = variables[k].name;
      history.name[k] = first || name == history.name[k] ? variables[k].name : shared[k].c_str();
      history.changes[k] = (!first && history.changes[k]) || variables[k].changes;
    }
    history.columns = std::max(history.columns, static_cast<int>(variables.size()));
  }
  const bool undrained = std::any_of(bodies.begin(), bodies.end(), [&](const BodyInput& body) {
    return materials[body.material].pore_stiffness > 0;
  });
  history.pore = undrained ? history.columns++ : -1;
  if (undrained) history.name[history.pore] = k_excess_pore_pressure, history.changes[history.pore] = true;
}

template <class Space, class T, int Dim>
void upload_soil(State<Space, T, Dim>& s, const std::vector<MaterialInput>& materials,
                 const std::vector<BodyInput>& bodies, const std::vector<RigidInput>& rigids, Fault& fault) {
  auto& soil = s.soil.points;
  std::vector<int> body_of, first;
  std::vector<double> position;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    first.push_back(static_cast<int>(body_of.size()));
    body_of.insert(body_of.end(), bodies[b].position.size() / Dim, static_cast<int>(b));
    position.insert(position.end(), bodies[b].position.begin(), bodies[b].position.end());
  }
  soil.count = static_cast<int>(body_of.size());
  soil.has_own_mass = soil.splits || std::any_of(bodies.begin(), bodies.end(),
                                                 [](const BodyInput& body) { return body.least_mass > 0; });
  name_columns(soil.history, materials, bodies);
  if (s.batches.in_use()) store_soil(s, soil.count, scratch_of_rigids<Space, T, Dim>(rigids));
  s.grid.fields = 1;
  for (const BodyInput& body : bodies) s.grid.fields = std::max(s.grid.fields, body.velocity_field + 1);
  const auto field_of = [&](int p) { return bodies[body_of[p]].velocity_field; };
  place_points(s.grid, s.spacing, position, field_of, s.soil, fault);

  const auto in_body = [&](int p) { return p - first[body_of[p]]; };
  const auto id_of = [&](int p) {
    const BodyInput& body = bodies[body_of[p]];
    return body.id.empty() ? p : body.id[in_body(p)];
  };
  fill_view(soil.id, "mpm::id", soil.count, id_of);
  if (fault.kind != FaultKind::none) fault.particle = id_of(fault.particle);
  fill_view(soil.body, "mpm::body", soil.count,
            [&](int p) { return static_cast<std::uint16_t>(body_of[p]); });
  fill_view(soil.velocity, "mpm::velocity", soil.count, [&](int p) {
    const BodyInput& body = bodies[body_of[p]];
    Vector<T, Dim> v;
    for (int d = 0; d < Dim; ++d)
      v[d] = static_cast<T>(body.particle_velocity.empty() ? body.velocity[d]
                                                           : body.particle_velocity[in_body(p) * Dim + d]);
    return v;
  });
  fill_view(soil.stress, "mpm::stress", soil.count, [&](int p) {
    const BodyInput& body = bodies[body_of[p]];
    SymTensor<T, Dim> stress{};
    const double excess = body.excess_pore_pressure.empty() ? 0 : body.excess_pore_pressure[in_body(p)];
    for (int k = 0; k < sym_size<Dim> && !body.stress.empty(); ++k)
      stress[k] = static_cast<T>(body.stress[in_body(p) * sym_size<Dim> + k]);
    if (excess != 0) add_isotropic(stress, static_cast<T>(-excess));
    return stress;
  });
  fill_view(soil.volume, "mpm::volume", soil.count, [&](int p) {
    const BodyInput& body = bodies[body_of[p]];
    return static_cast<T>(body.volume.empty() ? body.particle_volume : body.volume[in_body(p)]);
  });
  for (int k = 0; k < soil.history.columns; ++k)
    fill_view(soil.history.column[k], "mpm::history", soil.count, [&](int p) {
      const BodyInput& body = bodies[body_of[p]];
      const bool has = k < static_cast<int>(body.state.size());
      const std::vector<double> none, &values = k == soil.history.pore ? body.excess_pore_pressure
                                                : has                  ? body.state[k]
                                                                       : none;
      return static_cast<T>(values.empty() ? 0 : values[in_body(p)]);
    });
  fill_view(soil.bodies, "mpm::bodies", static_cast<int>(bodies.size()), [&](int b) {
    return BodyProperties<T>{static_cast<T>(common_mass(bodies[b])), static_cast<T>(bodies[b].half_length),
                             bodies[b].material};
  });
  fill_view(s.density, "mpm::density", static_cast<int>(bodies.size()),
            [&](int b) { return bodies[b].density; });
  if (soil.has_own_mass)
    fill_view(soil.mass, "mpm::mass", soil.count, [&](int p) {
      const BodyInput& body = bodies[body_of[p]];
      return static_cast<T>(body.mass.empty() ? common_mass(body) : body.mass[in_body(p)]);
    });
  if (soil.has_domain) {
    fill_view(soil.domain, "mpm::domain", soil.count, [&](int p) {
      const BodyInput& body = bodies[body_of[p]];
      constexpr int moments = Dim * (Dim + 1) / 2;
      auto domain = square_domain<T, Dim>(static_cast<T>(body.half_length));
      for (int k = 0; k < moments && !body.domain.empty(); ++k)
        domain[k] = static_cast<T>(body.domain[std::size_t(in_body(p)) * moments + k]);
      limit_domain(domain);
      return domain;
    });
    const auto domain = mirror_of(soil.domain);
    fill_view(soil.half_length, "mpm::half_length", soil.count, [&](int p) {
      return to_store<Space>(bounded_half_lengths(domain(p), soil.least_half_length));
    });
    fill_view(soil.begun, "mpm::begun", soil.count,
              [](int) { return filled<T, Dim>(0); });  // begin_domains()
    fill_view(soil.begun_volume, "mpm::begun_volume", soil.count, [](int) { return T(0); });
  }
  if (soil.has_periods)
    fill_view(soil.periods, "mpm::periods", soil.count, [](int) { return filled<T, Dim>(0); });
  for (int k = 0; k < soil.face_count; ++k)
    fill_view(soil.faces[k], "mpm::face", soil.count, [&](int p) {
      constexpr int size = FaceTerms<Dim>::size;
      const BodyInput& body = bodies[body_of[p]];
      Face<Dim> face{};
      for (int n = 0; n < size && !body.faces.empty(); ++n)
        face[n] = body.faces[(std::size_t(in_body(p)) * soil.face_count + k) * size + n];
      return face;
    });
  if (soil.splits)
    fill_view(soil.ancestor, "mpm::ancestor", soil.count, [&](int p) { return double(id_of(p)); });
  fill_view(soil.materials, "mpm::materials", static_cast<int>(materials.size()), [&](int m) {
    auto stored = store_material<T>(materials[m].model, materials[m].parameters, materials[m].object.get(),
                                    materials[m].pore_stiffness);
    stored.f_bar_share = static_cast<T>(materials[m].f_bar_share);
    return stored;
  });
  s.f_bar_by_material = std::any_of(bodies.begin(), bodies.end(), [&](const BodyInput& body) {
    return body.material != bodies.front().material;
  });
  s.law = bodies.empty() ? -1 : materials[bodies[0].material].model;
  s.light_laws = soil.history.pore < 0;
  for (const BodyInput& body : bodies) {
    const int model = materials[body.material].model;
    if (model != s.law) s.law = -1;
    s.light_laws = s.light_laws && has_model(LightMaterials{}, model);
  }
}

/// C_p of APIC at the start: the gradient of each body's velocities, so that a linear field is kept from the
/// first step on.
template <class Space, class T, int Dim>
void upload_affine(State<Space, T, Dim>& s, const std::vector<BodyInput>& bodies) {
  std::vector<double> gradient;
  std::array<int, 3> period{};
  for (int d = 0; d < Dim; ++d) period[d] = s.grid.period[d];
  for (const BodyInput& body : bodies) {
    std::vector<double> cells = body.position;
    for (double& x : cells) x /= s.spacing;
    if (!body.velocity_gradient.empty())
      gradient.insert(gradient.end(), body.velocity_gradient.begin(), body.velocity_gradient.end());
    else if (body.particle_velocity.empty())
      gradient.resize(gradient.size() + cells.size() * Dim);
    else
      for (const double g : velocity_gradients(cells, body.particle_velocity, Dim, period))
        gradient.push_back(g);
  }
  fill_view(s.soil.points.affine, "mpm::affine", s.soil.points.count, [&](int p) {
    Matrix<T, Dim> c;
    for (int k = 0; k < Dim * Dim; ++k) c[k] = static_cast<T>(gradient[std::size_t(p) * Dim * Dim + k]);
    return c;
  });
}

template <class Space, class T, int Dim>
void upload_rigids(State<Space, T, Dim>& s, const std::vector<RigidInput>& rigids, double cut, Fault& fault) {
  const double spacing = s.spacing;
  s.rigid_points.resize(rigids.size());
  for (std::size_t r = 0; r < rigids.size(); ++r) {
    auto& points = s.rigid_points[r].points;
    points.count = static_cast<int>(rigids[r].position.size() / Dim);
    points.mass = static_cast<T>(rigids[r].density * rigids[r].particle_volume);
    points.half_length = static_cast<T>(rigids[r].half_length);
    points.surface_normal = rigids[r].surface_normal;
    const bool sound = fault.kind == FaultKind::none;
    if (s.grid.fields > 1 && !rigids[r].surface_normal)
      throw std::invalid_argument("normals from the mass gradient know one velocity field only");
    const auto first_field = [](int) { return 0; };
    place_points(s.grid, spacing, rigids[r].position, first_field, s.rigid_points[r], fault);
    if (sound && fault.kind != FaultKind::none) fault.particle = -1 - static_cast<int>(r);
    fill_view(points.reference_position, "mpm::reference_position", points.count, [&](int p) {
      Vector<double, Dim> x;
      for (int d = 0; d < Dim; ++d) x[d] = rigids[r].position[std::size_t(p) * Dim + d] / spacing;
      return x;
    });
  }
  std::vector<Vertex> vertices;
  std::vector<int> first_vertex;
  for (const RigidInput& rigid : rigids) {
    first_vertex.push_back(static_cast<int>(vertices.size()));
    vertices.insert(vertices.end(), rigid.surface.vertices.begin(), rigid.surface.vertices.end());
  }
  fill_view(s.vertices, "mpm::vertices", static_cast<int>(vertices.size()),
            [&](int v) { return vertices[v]; });
  fill_view(s.rigids, "mpm::rigids", static_cast<int>(rigids.size()), [&](int r) {
    Rigid<Dim> rigid{};
    for (int d = 0; d < Dim; ++d) {
      rigid.velocity[d] = rigids[r].velocity[d];
      rigid.force[d] = rigids[r].force[d];
      rigid.held[d] = rigids[r].held[d];
    }
    const double particle_mass = rigids[r].density * rigids[r].particle_volume;
    rigid.mass = rigids[r].revolved_volume > 0
                     ? rigids[r].density * rigids[r].revolved_volume
                     : particle_mass * static_cast<double>(rigids[r].position.size() / Dim);
    rigid.dynamic = rigids[r].dynamic;
    rigid.shear_limit = rigids[r].shear_limit;
    rigid.shear_fraction = rigids[r].shear_fraction > 0 ? rigids[r].shear_fraction : -1;
    rigid.friction = rigids[r].friction;
    rigid.surface_normal = rigids[r].surface_normal;
    rigid.separates = rigids[r].separates;
    rigid.reach = rigids[r].reach;
    rigid.exponent = rigids[r].exponent;
    rigid.surface = surface_of<Dim>(rigids[r].surface, s.spacing);
    rigid.surface.first = first_vertex[r];
    rigid.mass_cut = cut * particle_mass;
    return rigid;
  });
}

}  // namespace

template <int Dim>
Surface<Dim> surface_of(const SurfaceInput& in, double spacing) {
  Surface<Dim> out{};
  out.kind = in.kind;
  for (int d = 0; d < Dim; ++d)
    out.centre[d] = in.centre[d], out.half[d] = in.half[d], out.normal[d] = in.normal[d];
  out.radius = in.radius;
  out.cosine = std::cos(in.angle), out.sine = std::sin(in.angle);
  out.count = static_cast<int>(in.vertices.size());
  out.columns = in.columns;
  out.round_off = k_on_edge * spacing;
  return out;
}

template Surface<2> surface_of(const SurfaceInput&, double);
template Surface<3> surface_of(const SurfaceInput&, double);

template <class Space, class T, int Dim>
Fault upload(State<Space, T, Dim>& s, const GridInput& grid, const std::vector<MaterialInput>& materials,
             const std::vector<BodyInput>& bodies, const std::vector<RigidInput>& rigids) {
  // Shares of a particle's mass. A node's weight falls with the square of its gradient, so a node that is
  // left out with 1e-14 would have felt a ten-millionth of a particle's force, and with 1e-12 a millionth; a
  // rigid holds a node that it reaches by a thousandth of a cell.
  constexpr double k_cut = sizeof(T) == sizeof(double) ? 1e-14 : 1e-12, k_rigid_cut = 1e-6;
  s.grid.spacing = static_cast<T>(grid.spacing);
  s.grid.inv_spacing = static_cast<T>(1 / grid.spacing);
  for (int d = 0; d < Dim; ++d) {
    s.grid.cells[d] = grid.cells[d];
    s.grid.patches[d] = grid.patches[d];
    const bool periodic = grid.walls[d][0] == Wall::periodic;
    s.grid.period[d] = periodic ? grid.cells[d] : 0;
    for (int side = 0; side < 2; ++side) s.grid.wall[d][side] = periodic ? Wall::free : grid.walls[d][side];
  }
  s.soil.points.has_periods = s.grid.is_periodic();
  s.spacing = grid.spacing;
  Fault fault{};
  s.mass_cut = std::numeric_limits<double>::max();
  for (const BodyInput& body : bodies)
    s.mass_cut = std::min(s.mass_cut, k_cut * (body.least_mass > 0 ? body.least_mass : common_mass(body)));
  double smallest = std::numeric_limits<double>::max(), largest = 0;
  for (const BodyInput& body : bodies) {
    smallest = std::min(smallest, body.most_volume > 0 ? body.least_volume : body.particle_volume);
    largest = std::max(largest, body.most_volume > 0 ? body.most_volume : body.particle_volume);
  }
  double least_half_length = k_least_half_length;
  for (const BodyInput& body : bodies) least_half_length = std::min(least_half_length, body.half_length);
  s.soil.points.least_half_length = static_cast<T>(least_half_length);
  if (s.soil.points.splits) smallest *= k_least_piece, s.mass_cut *= k_least_piece;
  s.strays.least_volume = k_least_volume * smallest, s.strays.most_volume = k_most_volume * largest;
  const bool alike = smallest == largest && !s.soil.points.splits;
  fill_view(s.strays.start_volume, "mpm::start_volume", alike ? 0 : static_cast<int>(bodies.size()),
            [&](int b) { return bodies[b].weighed ? 1 / bodies[b].density : 0; });
  s.strays.lost.assign(bodies.size(), {});
  s.strays.put_back = decltype(s.strays.put_back)("mpm::put_back", bodies.size());
  s.rigid_moves = s.rigid_dynamic = s.mass_normals = s.soil_boundary = s.shear_fraction = s.has_friction =
      false;
  for (const RigidInput& rigid : rigids) {
    s.rigid_moves =
        s.rigid_moves || rigid.dynamic || rigid.timed || rigid.velocity != std::array<double, 3>{};
    s.rigid_dynamic = s.rigid_dynamic || rigid.dynamic;
    s.has_friction = s.has_friction || rigid.friction > 0;
    s.mass_normals = s.mass_normals || !rigid.surface_normal;
    s.soil_boundary = s.soil_boundary || rigid.surface_normal || rigid.shear_limit > 0 || rigid.reach > 0;
    s.shear_fraction = s.shear_fraction || rigid.shear_fraction > 0;
    s.soil_boundary = s.soil_boundary || rigid.shear_fraction > 0;
  }
  s.control = ControlView<Space>("mpm::control");
  s.never_paused = ControlView<Space>("mpm::never_paused");
  s.launch_barrier = decltype(s.launch_barrier)("mpm::launch_barrier");
  s.movements.bits = decltype(s.movements.bits)("mpm::movements");
  s.launch_movements.bits = decltype(s.launch_movements.bits)("mpm::launch_movements");
  s.rigid_force = decltype(s.rigid_force)("mpm::rigid_force", Dim * rigids.size());
  upload_soil(s, materials, bodies, rigids, fault);
  if (s.affine) upload_affine(s, bodies);
  upload_rigids(s, rigids, k_rigid_cut, fault);
  if (fault.kind != FaultKind::none) return fault;
  sort_and_list(s);
  begin_domains(s);
  return fault;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                              \
  template Fault upload(State<Space, T, Dim>&, const GridInput&, const std::vector<MaterialInput>&, \
                        const std::vector<BodyInput>&, const std::vector<RigidInput>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
