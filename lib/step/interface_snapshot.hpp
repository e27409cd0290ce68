#pragma once
// Contact of deformable bodies in a frame.

#include <petscsys.h>

#include "common/snapshot.hpp"
#include "step/step_context.hpp"

namespace mpm {

/// Adds a group for each pair of bodies that have velocity fields of their own: the nodes at which they act
/// on each other, with the force on the first body, the normal out of it, the area, and the stress: pressure
/// (compression positive) and shear on the first body. They are those of a step of dt [s] from the present
/// state, with loads as they are set. All ranks have all nodes. Collective.
template <class Space, class T, int Dim>
PetscErrorCode add_interfaces(StepContext<Space, T, Dim>& run, double dt, Snapshot* out);

}  // namespace mpm
