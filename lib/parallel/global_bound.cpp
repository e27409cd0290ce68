#include "parallel/global_bound.hpp"

namespace mpm {

PetscErrorCode GlobalBound::post(MPI_Comm comm, const BoundReport& own) {
  PetscFunctionBeginUser;
  last_ = 1 - last_;
  Reduction& r = reductions_[last_];
  r.own = {own.bound, own.increment, own.stopped};
  r.posted = true;
  PetscCallMPI(MPI_Iallreduce(r.own.data(), r.all.data(), 3, MPI_DOUBLE, MPI_MAX, comm, &r.request));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GlobalBound::last_but_one(bool* known, BoundReport* all) {
  PetscFunctionBeginUser;
  Reduction& r = reductions_[1 - last_];
  *known = r.posted;
  if (r.posted) PetscCallMPI(MPI_Wait(&r.request, MPI_STATUS_IGNORE));
  const bool stepped = r.posted && r.all[0] > 0;  // else it is of the time before the first step
  r.posted = false;
  if (stepped) sum_ += r.all[1];
  *all = {sum_, r.all[1], r.all[2]};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GlobalBound::drain() {
  PetscFunctionBeginUser;
  for (Reduction& r : reductions_) {
    if (r.posted) PetscCallMPI(MPI_Wait(&r.request, MPI_STATUS_IGNORE));
    r.posted = false;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GlobalBound::now(MPI_Comm comm, BoundReport* report) {
  PetscFunctionBeginUser;
  double values[3] = {report->bound, report->increment, report->stopped};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, 3, MPI_DOUBLE, MPI_MAX, comm));
  *report = {values[0], values[1], values[2]};
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
