#pragma once
// element.csv: what a single material point did along its path.

#include <string>
#include <vector>

#include "element/drive.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {

/// The line of names: time, stress, state variables that frames have, strain since the start.
std::string element_header(const std::vector<StateVariable>& state);

/// The line of a point: s, Pa, the state variables' units, - (tensor shear strains).
std::string element_line(const std::vector<StateVariable>& state, const DrivenPoint& point);

}  // namespace mpm
