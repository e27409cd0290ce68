#include "output/frame_fields.hpp"

#include <algorithm>
#include <cctype>

#include "common/text.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {

const std::vector<Field>& frame_fields() {
  static const std::vector<Field> fields = [] {
    std::vector<Field> all;
    for (const ParticleColumn& column : k_particle_columns)
      if (column.framed != Framed::no)
        all.push_back({column.name, column.unit, framed_width(column.width), column.framed, column.values,
                       column.carried == Carried::if_needed});
    all.push_back({"grid_velocity", "m/s", 3, Framed::bodies, &ParticleSnapshot::grid_velocity});
    const auto is_new = [&](const char* name) {
      return std::none_of(all.begin(), all.end(),
                          [&](const Field& f) { return std::string(f.name) == name; });
    };
    for (int model = 0; model < static_cast<int>(material_models().size()); ++model)
      for (const StateVariable& variable : state_variables(model))
        if (variable.output && is_new(variable.name))
          all.push_back({variable.name, variable.unit, 1, Framed::bodies, nullptr});
    for (int model = 0; model < static_cast<int>(material_models().size()); ++model)
      for (const StateVariable& variable : state_variables(model))
        if (variable.parameter != nullptr && is_new(variable.parameter))
          all.push_back({variable.parameter, variable.unit, 1, Framed::bodies, nullptr});
    const Field last[] = {{"pore_pressure", "Pa", 1, Framed::bodies, nullptr},
                          {k_excess_pore_pressure, "Pa", 1, Framed::bodies, nullptr},
                          {"porosity", "-", 1, Framed::bodies, nullptr},
                          {"half_length_x", "m", 1, Framed::bodies, nullptr},
                          {"half_length_y", "m", 1, Framed::bodies, nullptr},
                          {"half_length_z", "m", 1, Framed::bodies, nullptr},
                          {"periods_x", "-", 1, Framed::bodies, nullptr},
                          {"periods_y", "-", 1, Framed::bodies, nullptr},
                          {"periods_z", "-", 1, Framed::bodies, nullptr},
                          {"load_area_x", "m2", 1, Framed::bodies, nullptr},
                          {"load_area_y", "m2", 1, Framed::bodies, nullptr},
                          {"load_area_z", "m2", 1, Framed::bodies, nullptr},
                          {"number", "-", 1, Framed::nodes, &ParticleSnapshot::number},
                          {"contact_force", "N", 3, Framed::contacts, nullptr},
                          {"contact_normal", "-", 3, Framed::contacts, nullptr},
                          {"contact_area", "m2", 1, Framed::contacts, nullptr},
                          {"contact_pressure", "Pa", 1, Framed::contacts, nullptr},
                          {"contact_shear", "Pa", 3, Framed::contacts, nullptr}};
    all.insert(all.end(), std::begin(last), std::end(last));
    return all;
  }();
  return fields;
}

std::string frame_field_list() {
  const auto names = frame_field_names();
  const auto is_numbered = [&](std::size_t k) {
    return k < names.size() && std::isdigit(static_cast<unsigned char>(names[k].back())) != 0;
  };
  std::vector<std::string> pieces;
  for (std::size_t k = 0; k < names.size(); ++k) {
    pieces.push_back(names[k]);
    if (!is_numbered(k)) continue;
    while (is_numbered(k + 1)) ++k;
    if (names[k] != pieces.back()) pieces.back() += " to " + names[k];
  }
  return join(pieces, ", ");
}

const std::vector<double>* values_of(const ParticleSnapshot& particles, const Field& field) {
  if (field.of_flow && !particles.has_flow) return nullptr;
  if (field.values != nullptr) return &(particles.*field.values);
  for (const StateField& state : particles.state)
    if (state.name == field.name) return &state.values;
  return nullptr;
}

}  // namespace mpm
