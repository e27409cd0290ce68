#pragma once
// The particles of a frame, from the ranks that hold them.

#include <petscsys.h>

#include "output/snapshot.hpp"

namespace mpm {

/// Brings all particles of a body to rank 0, in the order of their ids; the other ranks are left with none.
/// Collective.
PetscErrorCode gather_particles(MPI_Comm comm, ParticleSnapshot* body);

}  // namespace mpm
