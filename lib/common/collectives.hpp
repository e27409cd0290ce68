#pragma once
// Collectives beside the exchange of a step: ranks agree on errors and texts, and send each other records.

#include <petscsys.h>

#include <algorithm>
#include <string>
#include <type_traits>
#include <vector>

namespace mpm {

PetscMPIInt rank_of(MPI_Comm comm);
PetscMPIInt size_of(MPI_Comm comm);

/// Makes the outcome of work that one rank did alone known on every rank. Where it failed, that rank has
/// printed why; the others fail without a message.
PetscErrorCode agree(MPI_Comm comm, PetscErrorCode own);

/// The text of the lowest rank that has one, on every rank; empty if none has.
PetscErrorCode share_text(MPI_Comm comm, std::string* text);
/// Numbers of rank 0, on every rank.
PetscErrorCode share_numbers(MPI_Comm comm, int count, double* values);

/// Records of `size` bytes: out[r] holds those for rank r, one after the other; `in` gets what came, in the
/// order of ranks.
PetscErrorCode exchange_records(MPI_Comm comm, std::size_t size, const std::vector<std::vector<char>>& out,
                                std::vector<char>* in);

/// Bytes of all ranks, in the order of ranks, on every rank; records of `size` bytes stay whole.
PetscErrorCode share_bytes(MPI_Comm comm, std::size_t size, std::vector<char>* bytes);
/// Records of all ranks, likewise.
template <class Record>
PetscErrorCode share_records(MPI_Comm comm, std::vector<Record>* records) {
  static_assert(std::is_trivially_copyable_v<Record>);
  PetscFunctionBeginUser;
  if (size_of(comm) == 1) PetscFunctionReturn(PETSC_SUCCESS);
  const char* const own = reinterpret_cast<const char*>(records->data());
  std::vector<char> bytes(own, own + records->size() * sizeof(Record));
  PetscCall(share_bytes(comm, sizeof(Record), &bytes));
  PetscCallCXX(records->resize(bytes.size() / sizeof(Record)));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(records->data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
