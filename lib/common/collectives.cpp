#include "common/collectives.hpp"

#include <algorithm>
#include <numeric>

namespace mpm {

PetscMPIInt rank_of(MPI_Comm comm) {
  PetscMPIInt rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

PetscMPIInt size_of(MPI_Comm comm) {
  PetscMPIInt size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

PetscErrorCode agree(MPI_Comm comm, PetscErrorCode own) {
  if (size_of(comm) == 1) return own;
  int mine = static_cast<int>(own), worst = mine;
  MPI_Allreduce(&mine, &worst, 1, MPI_INT, MPI_MAX, comm);
  return static_cast<PetscErrorCode>(worst);
}

PetscErrorCode share_text(MPI_Comm comm, std::string* text) {
  PetscFunctionBeginUser;
  const int size = size_of(comm), rank = rank_of(comm);
  if (size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  int mine = text->empty() ? size : rank, first = size;
  PetscCallMPI(MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm));
  if (first == size) PetscFunctionReturn(PETSC_SUCCESS);
  int length = static_cast<int>(text->size());
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_INT, first, comm));
  text->resize(length);
  PetscCallMPI(MPI_Bcast(text->data(), length, MPI_CHAR, first, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode share_numbers(MPI_Comm comm, int count, double* values) {
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Bcast(values, count, MPI_DOUBLE, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode exchange_records(MPI_Comm comm, std::size_t size, const std::vector<std::vector<char>>& out,
                                std::vector<char>* in) {
  PetscFunctionBeginUser;
  const int ranks = size_of(comm);
  std::vector<int> sent(ranks), came(ranks), sent_at(ranks), came_at(ranks);
  std::vector<char> all;
  for (int r = 0; r < ranks; ++r) {
    sent[r] = static_cast<int>(out[r].size() / size);
    all.insert(all.end(), out[r].begin(), out[r].end());
  }
  PetscCallMPI(MPI_Alltoall(sent.data(), 1, MPI_INT, came.data(), 1, MPI_INT, comm));
  std::exclusive_scan(sent.begin(), sent.end(), sent_at.begin(), 0);
  std::exclusive_scan(came.begin(), came.end(), came_at.begin(), 0);
  in->resize(size * (came_at.back() + came.back()));
  MPI_Datatype record;  // counts are of records, so that they stay below 2^31
  PetscCallMPI(MPI_Type_contiguous(static_cast<int>(size), MPI_BYTE, &record));
  PetscCallMPI(MPI_Type_commit(&record));
  PetscCallMPI(MPI_Alltoallv(all.data(), sent.data(), sent_at.data(), record, in->data(), came.data(),
                             came_at.data(), record, comm));
  PetscCallMPI(MPI_Type_free(&record));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode share_bytes(MPI_Comm comm, std::size_t size, std::vector<char>* bytes) {
  PetscFunctionBeginUser;
  const int ranks = size_of(comm), own = static_cast<int>(bytes->size() / size);
  std::vector<int> counts(ranks), begins(ranks);
  PetscCallMPI(MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, comm));
  std::exclusive_scan(counts.begin(), counts.end(), begins.begin(), 0);
  std::vector<char> all(size * (begins.back() + counts.back()));
  MPI_Datatype record;
  PetscCallMPI(MPI_Type_contiguous(static_cast<int>(size), MPI_BYTE, &record));
  PetscCallMPI(MPI_Type_commit(&record));
  PetscCallMPI(
      MPI_Allgatherv(bytes->data(), own, record, all.data(), counts.data(), begins.data(), record, comm));
  PetscCallMPI(MPI_Type_free(&record));
  *bytes = std::move(all);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
