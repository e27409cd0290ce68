#include "common/material_table.hpp"

#include <cmath>

namespace mpm {

int model_index(const std::string& name) {
  const auto models = material_models();
  for (std::size_t k = 0; k < models.size(); ++k)
    if (name == models[k]) return static_cast<int>(k);
  return -1;
}

std::vector<StateVariable> state_variables(const std::string& model) {
  const int index = model_index(model);
  return index < 0 ? std::vector<StateVariable>{} : state_variables(index);
}

std::string own_parameter(const std::vector<StateVariable>& variables) {
  for (const StateVariable& variable : variables)
    if (variable.parameter != nullptr) return variable.parameter;
  return "";
}

std::optional<double> shear_wave_ratio(const MaterialConfig& material) {
  const int index = model_index(material.model);
  if (index < 0) return {};
  const double nu = parameter_of(index, material.parameters, "poisson"),
               modulus = parameter_of(index, material.parameters, "shear_modulus");  // in lieu of the ratio
  if (std::isnan(nu) || modulus > 0) return {};
  return std::sqrt((1 - 2 * nu) / (2 - 2 * nu));
}

std::vector<StateVariable> state_variables(const MaterialConfig& material) {
  const int index = model_index(material.model);
  return index < 0 ? std::vector<StateVariable>{} : state_variables(index, material.parameters);
}

}  // namespace mpm
