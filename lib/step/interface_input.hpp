#pragma once
// Contact of deformable bodies between configuration, state and history.

#include "mpm/config.hpp"
#include "transfer/upload_interfaces.hpp"

namespace mpm {

/// What acts between the velocity fields of a run; nothing where it has one.
InterfaceInput interface_input(const Config& config);

}  // namespace mpm
