#pragma once
// Contact of deformable bodies between configuration, state and history.

#include "mpm/config.hpp"
#include "transfer/upload_interfaces.hpp"

namespace mpm {

/// Laws between the velocity fields of a run; none where it has one field.
InterfaceInput interface_input(const Config& config);

}  // namespace mpm
