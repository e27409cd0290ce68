#pragma once
// Whether a time step is short enough for springs and dashpots of rigid bodies.

#include <string>

#include "mpm/config.hpp"

namespace mpm {

/// A line for the user where a spring or a dashpot of a rigid body is too stiff for a time step [s]; empty
/// where none is.
std::string spring_fault(const Config& config, double dt);

}  // namespace mpm
