#pragma once
// Collectives beside the exchange of a step: ranks agree on errors and texts, and send each other records.

#include <petscsys.h>

#include <string>
#include <vector>

namespace mpm {

PetscMPIInt rank_of(MPI_Comm comm);
PetscMPIInt size_of(MPI_Comm comm);

/// What one rank did alone, as it ended there, on every rank. Where it failed, the rank that failed has said
/// why; the others fail without a word.
PetscErrorCode agree(MPI_Comm comm, PetscErrorCode own);

/// The text of the lowest rank that has one, on every rank; empty if none has.
PetscErrorCode share_text(MPI_Comm comm, std::string* text);
/// Numbers of rank 0, on every rank.
PetscErrorCode share_numbers(MPI_Comm comm, int count, double* values);

/// Records of `size` bytes: out[r] holds those for rank r, one after the other; `in` gets what came, in the
/// order of ranks.
PetscErrorCode exchange_records(MPI_Comm comm, std::size_t size, const std::vector<std::vector<char>>& out,
                                std::vector<char>* in);

}  // namespace mpm
