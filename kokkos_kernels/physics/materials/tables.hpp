#pragma once
// Contents of the laws' tables, for code that does not include the laws.

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mpm {

/// One state variable of a law: what each of its particles carries beside the stress. Sorting, migration,
/// checkpoints, batches, frames and starts from files follow the table of a law's state variables.
struct StateVariable {
  const char* name;  // in frames, checkpoints and files of particles
  const char* unit;
  bool changes = true;  // update() changes it; else it follows from where the particle was created
  bool output = true;   // frames have it
  bool used = true;     // update() asks for it
  const char* parameter = nullptr;  // key of the parameter whose value at the particle it is, which a file of
                                    // particles may give; at most k_most_own variables of a law have one
};

/// Values that a particle has of its own, of the parameters of StateVariable::parameter in the order of the
/// law's table, in their units; none where the material gives it.
inline constexpr int k_most_own = 2;
using OwnValues = std::array<std::optional<double>, k_most_own>;

/// Name of the excess pore pressure [Pa] in frames, checkpoints and files of particles. Particles of a
/// material with a pore stiffness carry it beside the state of their law.
inline constexpr const char* k_excess_pore_pressure = "excess_pore_pressure";

/// Name of each model in the list, in its order.
std::vector<const char*> material_models();

/// Whether the stiffness of the model of this index in Materials depends on stress or state.
bool stiffness_changes(int which);

/// Whether the model of this index in Materials runs on processors in double precision alone.
bool on_host_in_double(int which);

/// Message about a particle that the model of this index in Materials calls failed, the end of "a particle
/// ..."; empty where no state is a failure.
const char* failure_of(int which);

/// All state variables of the model of this index in Materials; a material may do without some.
std::vector<StateVariable> state_variables(int which);

/// The state variables that the particles of a material of this model and these parameters carry.
std::vector<StateVariable> state_variables(int which, const std::vector<double>& parameters);

/// The value of the parameter with this key of a material with these parameters; NaN where its model has
/// none.
double parameter_of(int which, const std::vector<double>& parameters, const std::string& key);

}  // namespace mpm
