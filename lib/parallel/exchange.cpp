#include "parallel/exchange.hpp"

namespace mpm {

NodeExchange::~NodeExchange() {
  PetscBool up = PETSC_FALSE;
  if (PetscInitialized(&up) != PETSC_SUCCESS || !up) return;
  if (sf_ != nullptr) (void)PetscSFDestroy(&sf_);
  for (Unit& unit : units_) MPI_Type_free(&unit.type);
}

PetscErrorCode NodeExchange::set_up(MPI_Comm comm, const std::vector<int>& neighbours,
                                    const std::vector<int>& begin) {
  constexpr int k_tag = 17;
  PetscFunctionBeginUser;
  // Where my entries begin in each neighbour's buffer.
  const int count = static_cast<int>(neighbours.size());
  std::vector<int> there(count);
  std::vector<MPI_Request> requests(2 * count);
  for (int n = 0; n < count; ++n) {
    PetscCallMPI(MPI_Irecv(&there[n], 1, MPI_INT, neighbours[n], k_tag, comm, &requests[2 * n]));
    PetscCallMPI(MPI_Isend(&begin[n], 1, MPI_INT, neighbours[n], k_tag, comm, &requests[2 * n + 1]));
  }
  PetscCallMPI(MPI_Waitall(2 * count, requests.data(), MPI_STATUSES_IGNORE));

  const PetscInt entries = begin.back();
  PetscSFNode* remote = nullptr;
  PetscCall(PetscMalloc1(entries, &remote));
  for (int n = 0; n < count; ++n)
    for (int e = begin[n]; e < begin[n + 1]; ++e) {
      remote[e].rank = neighbours[n];
      remote[e].index = there[n] + e - begin[n];
    }
  PetscCall(PetscSFDestroy(&sf_));
  PetscCall(PetscSFCreate(comm, &sf_));
  PetscCall(PetscSFSetGraph(sf_, entries, entries, nullptr, PETSC_OWN_POINTER, remote, PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(sf_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode NodeExchange::unit_of(MPI_Datatype real, int width, MPI_Datatype* unit) {
  PetscFunctionBeginUser;
  for (const Unit& known : units_)
    if (known.real == real && known.width == width) {
      *unit = known.type;
      PetscFunctionReturn(PETSC_SUCCESS);
    }
  PetscCallMPI(MPI_Type_contiguous(width, real, unit));
  PetscCallMPI(MPI_Type_commit(unit));
  units_.push_back({real, width, *unit});
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode NodeExchange::start(MPI_Datatype real, int width, const void* out, void* in) {
  PetscFunctionBeginUser;
  PetscCall(unit_of(real, width, &under_way_));
  out_ = out;
  in_ = in;
  PetscCall(PetscSFBcastWithMemTypeBegin(sf_, under_way_, PETSC_MEMTYPE_HOST, out, PETSC_MEMTYPE_HOST, in,
                                         MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode NodeExchange::finish() {
  PetscFunctionBeginUser;
  PetscCall(PetscSFBcastEnd(sf_, under_way_, out_, in_, MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
