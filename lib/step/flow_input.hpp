#pragma once
// Water that flows in pores, between configuration and state.

#include "mpm/config.hpp"
#include "transfer/upload_flow.hpp"

namespace mpm {

/// Pores of the materials, the water in them, and the sides of the mesh as the flux meets them; no pores
/// where no water flows.
FlowInput flow_input(const Config& config);

}  // namespace mpm
