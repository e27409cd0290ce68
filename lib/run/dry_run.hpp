#pragma once
#include "run/clock.hpp"
#include "run/time_step.hpp"

namespace mpm {

/// -dry_run: prints what the run would take. Writes nothing.
PetscErrorCode dry_run(Job& job, TimeStep& time_step, Clock& clock);

}  // namespace mpm
