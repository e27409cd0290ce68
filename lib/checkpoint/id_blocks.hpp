#pragma once
// From the points that each rank has, in any order, to equal blocks by number, one a rank.

#include <petscsys.h>

#include "checkpoint/checkpoint.hpp"

namespace mpm {

/// The block of a rank.
IdBlock block_of(long total, int rank, int ranks);

/// Brings the points of all ranks into blocks by number: `points` becomes the block of this rank, in order. A
/// point that several ranks have is kept once. Of `total` points `lost` are on no rank: their rows have the
/// address -1. Collective.
PetscErrorCode bring_to_blocks(MPI_Comm comm, long total, long lost, SavedPoints& points, IdBlock* block);

/// Leaves out the rows of particles that have left the run.
void leave_out_lost(SavedPoints& points);

/// Ids that were given and belong to no particle of the run: of what has left or was taken up by others, and
/// of what is not placed.
long ids_without_particle(const SavedState& state);

/// Brings the state into the form that a checkpoint of it would give each rank: its block of the particles,
/// and all impulses. Collective.
PetscErrorCode bring_together(MPI_Comm comm, SavedState* state);

/// Brings the impulses of all ranks together, in order of address, on every rank. A node that several ranks
/// have is kept once, of the first. Collective.
PetscErrorCode gather_impulse(MPI_Comm comm, SavedImpulse& impulse);

}  // namespace mpm
