#pragma once
// Inertia of rigid bodies that turn.

#include "mpm/config.hpp"
#include "transfer/upload.hpp"

namespace mpm {

/// Centre of mass [m from the mesh's lower corner], principal moments of inertia with their axes, and
/// farthest point of a rigid body that may turn; of others nothing. `in` has its particles and density.
/// Throws std::runtime_error where the inertia is not that of a body.
RigidTurning turning_of(const Config& config, const RigidConfig& rigid, const RigidInput& in);

}  // namespace mpm
