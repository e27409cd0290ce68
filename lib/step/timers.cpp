#include "step/timers.hpp"

namespace mpm {

const char* name_of(StepPhase f) {
  switch (f) {
    case StepPhase::reset: return "initialise nodal variables";
    case StepPhase::rigid_to_nodes: return "rigid bodies to nodes";
    case StepPhase::soil_to_nodes: return "soil particles to nodes";
    case StepPhase::nodes: return "nodal velocities, contact";
    case StepPhase::particles: return "stress update, movement";
    case StepPhase::rigids: return "move rigid bodies";
    case StepPhase::persistent: return "persistent steps";
    case StepPhase::energy: return "works of the energy balance";
    default: return "rebuild bins and lists";
  }
}

PetscErrorCode Timers::create() {
  PetscFunctionBeginUser;
  PetscClassId id = 0;  // registered once: PETSc has room for so many
  for (int n = 0; n < k_functions; ++n) {
    const char* name = name_of(static_cast<StepPhase>(n));
    PetscBool known = PETSC_FALSE;
    PetscCall(PetscLogEventGetId(name, &events_[n]));
    known = events_[n] >= 0 ? PETSC_TRUE : PETSC_FALSE;
    if (known) continue;
    if (id == 0) PetscCall(PetscClassIdRegister("mpm", &id));
    PetscCall(PetscLogEventRegister(name, id, &events_[n]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
