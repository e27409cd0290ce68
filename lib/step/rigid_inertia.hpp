#pragma once
// Inertia of rigid bodies that turn.

#include "mpm/config.hpp"
#include "transfer/upload.hpp"

namespace mpm {

/// How a rigid body turns by `rigid`: its centre of mass [m from the mesh's lower corner], principal moments
/// of inertia and axes, and its farthest point. `in` has its particles and density. Throws std::runtime_error
/// where the inertia is not that of a body.
RigidTurning turning_of(const Config& config, const RigidConfig& rigid, const RigidInput& in);

}  // namespace mpm
