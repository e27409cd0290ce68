#pragma once
// Entries of the tables of the laws for a material, by the word of its model.

#include <optional>
#include <string>
#include <vector>

#include "mpm/config.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {

/// Index in Materials of the model of this name; -1 where there is none.
int model_index(const std::string& name);

/// All state variables of the law of this name; none where there is no such law.
std::vector<StateVariable> state_variables(const std::string& model);

/// Keys of the parameters that each particle of a material may have values of its own of (a field or a file
/// of particles gives them), in the order of OwnValues.
std::vector<std::string> own_parameters(const std::vector<StateVariable>& variables);

/// Parameters of which a field or a file gives each particle of a body its own value.
std::vector<std::string> given_parameters(const BodyConfig& body,
                                          const std::vector<StateVariable>& variables);

/// The state variables that the particles of a material carry; none where there is no such law.
std::vector<StateVariable> state_variables(const MaterialConfig& material);

/// Speed of shear waves over that of pressure waves in the drained material, by its Poisson's ratio; none
/// where its law has no such parameter or does not use it.
std::optional<double> shear_wave_ratio(const MaterialConfig& material);

}  // namespace mpm
