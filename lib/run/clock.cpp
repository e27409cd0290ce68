#include "run/clock.hpp"

#include "common/text.hpp"

namespace mpm {

PetscErrorCode fail(Job& job, const Clock& clock, const std::string& what) {
  PetscFunctionBeginUser;
  job.outcome = Outcome::failed;
  PetscCall(job.log.error(formatted("mpm: step %ld, time %.9g s: ", clock.step, clock.time()) + what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
