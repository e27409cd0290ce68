#pragma once
// What the tables of the laws say of a material, by the word of its model.

#include <string>
#include <vector>

#include "physics/materials/tables.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Index in Materials of the model of this name; -1 where there is none.
int model_index(const std::string& name);

/// All state variables of the law of this name; none where there is no such law.
std::vector<StateVariable> state_variables(const std::string& model);

/// The state variables that the particles of a material carry; none where there is no such law.
std::vector<StateVariable> state_variables(const MaterialConfig& material);

}  // namespace mpm
