#include "parallel/exchange.hpp"

namespace mpm {
namespace {

constexpr int k_tag = 17;

}  // namespace

NodeExchange::~NodeExchange() {
  PetscBool up = PETSC_FALSE;
  if (PetscInitialized(&up) != PETSC_SUCCESS || !up) return;
  if (sf_ != nullptr) (void)PetscSFDestroy(&sf_);
  for (Unit& unit : units_) MPI_Type_free(&unit.type);
}

PetscErrorCode NodeExchange::set_up(MPI_Comm comm, const std::vector<int>& neighbours,
                                    const std::vector<int>& begin, bool by_sf) {
  PetscFunctionBeginUser;
  comm_ = comm, neighbours_ = neighbours, begin_ = begin;
  const int count = static_cast<int>(neighbours.size());
  there_.assign(count, 0);
  requests_.assign(2 * count, MPI_REQUEST_NULL);
  for (int n = 0; n < count; ++n) {
    PetscCallMPI(MPI_Irecv(&there_[n], 1, MPI_INT, neighbours[n], k_tag, comm, &requests_[2 * n]));
    PetscCallMPI(MPI_Isend(&begin[n], 1, MPI_INT, neighbours[n], k_tag, comm, &requests_[2 * n + 1]));
  }
  PetscCall(finish_messages());
  if (by_sf) PetscCall(make_sf(comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode NodeExchange::make_sf(MPI_Comm comm) {
  PetscFunctionBeginUser;
  const PetscInt entries = begin_.back();
  PetscSFNode* remote = nullptr;
  PetscCall(PetscMalloc1(entries, &remote));
  for (std::size_t n = 0; n < neighbours_.size(); ++n)
    for (int e = begin_[n]; e < begin_[n + 1]; ++e) {
      remote[e].rank = neighbours_[n];
      remote[e].index = there_[n] + e - begin_[n];
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

PetscErrorCode NodeExchange::start_messages(MPI_Datatype real, int width, const void* out, void* in) {
  PetscFunctionBeginUser;
  MPI_Datatype unit = MPI_DATATYPE_NULL;
  int size = 0;
  PetscCall(unit_of(real, width, &unit));
  PetscCallMPI(MPI_Type_size(unit, &size));
  for (std::size_t n = 0; n < neighbours_.size(); ++n) {
    const std::size_t first = std::size_t(begin_[n]) * size;
    const int count = begin_[n + 1] - begin_[n], rank = neighbours_[n];
    PetscCallMPI(
        MPI_Irecv(static_cast<char*>(in) + first, count, unit, rank, k_tag, comm_, &requests_[2 * n]));
    PetscCallMPI(MPI_Isend(static_cast<const char*>(out) + first, count, unit, rank, k_tag, comm_,
                           &requests_[2 * n + 1]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode NodeExchange::finish_messages() {
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
