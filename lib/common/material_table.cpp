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

std::vector<std::string> own_parameters(const std::vector<StateVariable>& variables) {
  std::vector<std::string> keys;
  for (const StateVariable& variable : variables)
    if (variable.parameter != nullptr) keys.push_back(variable.parameter);
  return keys;
}

std::vector<std::string> given_parameters(const BodyConfig& body,
                                          const std::vector<StateVariable>& variables) {
  std::vector<std::string> given;
  const auto keys = own_parameters(variables);
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (body.largest_own[k]) given.push_back(keys[k]);
  return given;
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
