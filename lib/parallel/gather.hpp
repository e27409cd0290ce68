#pragma once
// The particles of a frame, from the ranks that hold them.

#include <petscsys.h>

#include "common/snapshot.hpp"

namespace mpm {

/// Brings a body's particles into the order of their ids, over the ranks in equal parts, whoever holds them:
/// rank r gets those from total r / ranks to total (r + 1) / ranks. Collective.
PetscErrorCode order_particles(MPI_Comm comm, long total, ParticleSnapshot* body);

/// Brings the nodes of all ranks to rank 0, in the order of their numbers. Those that several ranks have are
/// the same on each. Collective.
PetscErrorCode gather_nodes(MPI_Comm comm, ParticleSnapshot* nodes);

}  // namespace mpm
