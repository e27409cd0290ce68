#include "transfer/upload_soil.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "physics/domain.hpp"
#include "physics/materials/any.hpp"
#include "physics/pore_water.hpp"
#include "physics/stretch_domain.hpp"
#include "rebuild/batches.hpp"
#include "transfer/place_points.hpp"
#include "transfer/velocity_gradients.hpp"

namespace mpm {
namespace {

/// The particles of all bodies, one body after the other.
struct Rows {
  const std::vector<BodyInput>& bodies;
  std::vector<int> body_of{};        // of each particle
  std::vector<std::size_t> first{};  // particle of each body
  std::vector<double> position{};    // m [Dim N]

  Rows(const std::vector<BodyInput>& of, int dim) : bodies(of) {
    for (std::size_t b = 0; b < of.size(); ++b) {
      first.push_back(body_of.size());
      body_of.insert(body_of.end(), of[b].position.size() / dim, static_cast<int>(b));
      position.insert(position.end(), of[b].position.begin(), of[b].position.end());
    }
  }
  int count() const { return static_cast<int>(body_of.size()); }
  const BodyInput& body(int p) const { return bodies[body_of[p]]; }
  std::size_t in_body(int p) const { return p - first[body_of[p]]; }
  int id(int p) const { return body(p).id.empty() ? p : body(p).id[in_body(p)]; }
};

/// Number k of a column that the particles of a body have in common.
double common_value(const BodyInput& body, Common common, int k) {
  switch (common) {
    case Common::velocity: return body.common_velocity[k];
    case Common::volume: return body.particle_volume;
    case Common::mass: return common_mass(body);
    case Common::zero: break;
  }
  return 0;
}

/// Checks that a column has `width` numbers for each particle of each body that gives it.
void check_column(const ParticleColumn& column, int width, const Rows& rows, int dim) {
  for (const BodyInput& body : rows.bodies) {
    const std::size_t count = body.position.size() / dim, numbers = (body.*column.values).size();
    if (numbers != 0 && numbers != count * width)
      throw std::invalid_argument(std::string("the column of a body has numbers for other particles: ") +
                                  column.name);
  }
}

/// Fills a vector of the soil from its column; without a column it is zero at the start.
template <int Dim, class View>
void fill_column(View& view, const char* name, const Rows& rows) {
  using Value = typename View::non_const_value_type;
  constexpr int n = components_of<Value>;
  const ParticleColumn* const column = column_of(name);
  if (column != nullptr) check_column(*column, n, rows, Dim);
  fill_view(view, std::string("mpm::") + name, rows.count(), [&](int p) {
    Value value{};
    if (column == nullptr) return value;
    auto* const numbers = reinterpret_cast<Number<Value>*>(&value);
    const std::vector<double>& given = rows.body(p).*column->values;
    for (int k = 0; k < n; ++k)
      numbers[k] = static_cast<Number<Value>>(given.empty() ? common_value(rows.body(p), column->common, k)
                                                            : given[rows.in_body(p) * n + k]);
    return value;
  });
}

/// As many columns as the materials of the bodies need, and their names: those of the variables where the
/// laws agree.
template <class Space, class T>
void name_columns(LawHistory<Space, T>& history, const std::vector<MaterialInput>& materials,
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
    return materials[body.material].has_pore_pressure();
  });
  history.pore = undrained ? history.columns++ : -1;
  if (undrained) history.name[history.pore] = k_excess_pore_pressure, history.changes[history.pore] = true;
}

/// State variable k of the laws, or the excess pore pressure.
template <class Space, class T>
void fill_history(LawHistory<Space, T>& history, int k, const Rows& rows) {
  const auto given_of = [&](const BodyInput& body) -> const std::vector<double>* {
    const int own = static_cast<int>(body.state.size());
    const bool has_pore = own > 0 && body.state.back().name == k_excess_pore_pressure;
    if (k == history.pore) return has_pore ? &body.state.back().values : nullptr;
    return k < own - has_pore ? &body.state[k].values : nullptr;
  };
  fill_view(history.column[k], "mpm::history", rows.count(), [&](int p) {
    const std::vector<double>* const given = given_of(rows.body(p));
    return static_cast<T>(given == nullptr || given->empty() ? 0 : (*given)[rows.in_body(p)]);
  });
}

/// Domains that stretch: those of the column, or the squares with which a run begins. begin_domains() sets
/// the rest.
template <class Space, class T, int Dim>
void fill_domains(Soil<Space, T, Dim>& soil, const Rows& rows) {
  constexpr int moments = Dim * (Dim + 1) / 2;
  fill_view(soil.domain, "mpm::domain", soil.count, [&](int p) {
    const BodyInput& body = rows.body(p);
    auto domain = square_domain<T, Dim>(static_cast<T>(body.half_length));
    for (int k = 0; k < moments && !body.domain.empty(); ++k)
      domain[k] = static_cast<T>(body.domain[rows.in_body(p) * moments + k]);
    limit_domain(domain);
    return domain;
  });
  const auto domain = mirror_of(soil.domain);
  fill_view(soil.half_length, "mpm::half_length", soil.count,
            [&](int p) { return to_store<Space>(bounded_half_lengths(domain(p), soil.least_half_length)); });
}

/// C_p of APIC at the start: the gradient of each body's velocities, so that a linear field is kept from the
/// first step on.
template <class Space, class T, int Dim>
void fill_affine(Core<Space, T, Dim>& s, const std::vector<BodyInput>& bodies) {
  std::vector<double> gradient;
  std::array<int, 3> period{};
  for (int d = 0; d < Dim; ++d) period[d] = s.grid.period[d];
  for (const BodyInput& body : bodies) {
    std::vector<double> cells = body.position;
    for (double& x : cells) x /= s.spacing;
    if (!body.velocity_gradient.empty())
      gradient.insert(gradient.end(), body.velocity_gradient.begin(), body.velocity_gradient.end());
    else if (body.velocity.empty())
      gradient.resize(gradient.size() + cells.size() * Dim);
    else
      for (const double g : velocity_gradients(cells, body.velocity, Dim, period)) gradient.push_back(g);
  }
  fill_view(s.soil.points.affine, "mpm::affine", s.soil.points.count, [&](int p) {
    Matrix<T, Dim> c;
    for (int k = 0; k < Dim * Dim; ++k) c[k] = static_cast<T>(gradient[std::size_t(p) * Dim * Dim + k]);
    return c;
  });
}

/// The surfaces of loads that particles are on.
template <class Space, class T, int Dim>
void fill_faces(Soil<Space, T, Dim>& soil, const Rows& rows) {
  constexpr int size = FaceTerms<Dim>::size;
  for (int k = 0; k < soil.face_count; ++k)
    fill_view(soil.faces[k], "mpm::face", soil.count, [&](int p) {
      const std::vector<double>& faces = rows.body(p).faces;
      Face<Dim> face{};
      for (int n = 0; n < size && !faces.empty(); ++n)
        face[n] = faces[(rows.in_body(p) * soil.face_count + k) * size + n];
      return face;
    });
}

/// Every vector of the soil but its positions.
template <class Space, class T, int Dim>
void fill_soil(Core<Space, T, Dim>& s, const Rows& rows) {
  auto& soil = s.soil.points;
  const auto fill = [&](const ParticleField& row, auto& field) {
    if (row.start == Start::column) fill_column<Dim>(field, row.name, rows);
  };
  for_each_field_of(fill, soil);
  fill_view(soil.id, "mpm::id", soil.count, [&](int p) { return rows.id(p); });
  fill_view(soil.body, "mpm::body", soil.count,
            [&](int p) { return static_cast<std::uint16_t>(rows.body_of[p]); });
  for (int k = 0; k < soil.history.columns; ++k) fill_history(soil.history, k, rows);
  if (soil.has_affine) fill_affine(s, rows.bodies);
  if (soil.has_domain) fill_domains(soil, rows);
  if (soil.splits)
    fill_view(soil.ancestor, "mpm::ancestor", soil.count, [&](int p) { return double(rows.id(p)); });
  if (soil.has_flow) fill_column<Dim>(soil.solid_volume, "solid_volume", rows);
  fill_faces(soil, rows);
}

/// Whether particles of a cell may differ in material, or the materials in their share of F-bar. Bodies of
/// different velocity fields have cells of their own.
bool mixes_materials(const std::vector<MaterialInput>& materials, const std::vector<BodyInput>& bodies) {
  for (const BodyInput& a : bodies)
    for (const BodyInput& b : bodies)
      if ((a.velocity_field == b.velocity_field && a.material != b.material) ||
          materials[a.material].f_bar_share != materials[b.material].f_bar_share)
        return true;
  return false;
}

/// Properties of bodies and materials, and what all of the soil has in common.
template <class Space, class T, int Dim>
void fill_properties(Core<Space, T, Dim>& s, const std::vector<MaterialInput>& materials,
                     const std::vector<BodyInput>& bodies) {
  auto& soil = s.soil.points;
  fill_view(soil.bodies, "mpm::bodies", static_cast<int>(bodies.size()), [&](int b) {
    return BodyProperties<T>{static_cast<T>(common_mass(bodies[b])), static_cast<T>(bodies[b].half_length),
                             bodies[b].material};
  });
  fill_view(s.density, "mpm::density", static_cast<int>(bodies.size()),
            [&](int b) { return bodies[b].density; });
  fill_view(soil.materials, "mpm::materials", static_cast<int>(materials.size()), [&](int m) {
    auto stored = store_material<T>(materials[m].model, materials[m].parameters, materials[m].object.get(),
                                    materials[m].pore_stiffness, materials[m].saturated);
    stored.f_bar_share = static_cast<T>(materials[m].f_bar_share);
    return stored;
  });
  s.f_bar.by_material = mixes_materials(materials, bodies);
  s.law = bodies.empty() ? -1 : materials[bodies[0].material].model;
  s.light_laws = soil.history.pore < 0;
  for (const BodyInput& body : bodies) {
    const int model = materials[body.material].model;
    if (model != s.law) s.law = -1;
    s.light_laws = s.light_laws && has_model(LightMaterials{}, model);
  }
}

}  // namespace

template <class Space, class T, int Dim>
void upload_soil(Core<Space, T, Dim>& s, const std::vector<MaterialInput>& materials,
                 const std::vector<BodyInput>& bodies, std::size_t scratch, Fault& fault) {
  auto& soil = s.soil.points;
  const Rows rows(bodies, Dim);
  soil.count = rows.count();
  const auto is_any = [&](auto&& has) { return std::any_of(bodies.begin(), bodies.end(), has); };
  soil.has_flow = is_any([&](const BodyInput& body) { return materials[body.material].saturated; });
  soil.has_own_mass =
      soil.splits || soil.has_flow || is_any([](const BodyInput& body) { return body.least_mass > 0; });
  name_columns(soil.history, materials, bodies);
  if (s.batches.in_use()) store_soil(s, soil.count, scratch);
  s.grid.fields = 1;
  for (const BodyInput& body : bodies) s.grid.fields = std::max(s.grid.fields, body.velocity_field + 1);
  const auto field_of = [&](int p) { return rows.body(p).velocity_field; };
  place_points(s.grid, s.spacing, rows.position, field_of, s.soil, fault);
  if (fault.kind != FaultKind::none) fault.particle = rows.id(fault.particle);
  fill_soil(s, rows);
  fill_properties(s, materials, bodies);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                               \
  template void upload_soil(Core<Space, T, Dim>&, const std::vector<MaterialInput>&, \
                            const std::vector<BodyInput>&, std::size_t, Fault&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
