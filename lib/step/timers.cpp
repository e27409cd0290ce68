#include "step/timers.hpp"

namespace mpm {

const char* name_of(Function f) {
  switch (f) {
    case Function::reset: return "initialise nodal variables";
    case Function::rigid_to_nodes: return "rigid bodies to nodes";
    case Function::soil_to_nodes: return "soil particles to nodes";
    case Function::nodes: return "nodal velocities, contact";
    case Function::particles: return "stress update, movement";
    case Function::rigids: return "move rigid bodies";
    case Function::whole: return "whole steps";
    default: return "rebuild bins and lists";
  }
}

PetscErrorCode Timers::create() {
  PetscFunctionBeginUser;
  PetscClassId id = 0;  // registered once: PETSc has room for so many
  for (int n = 0; n < k_functions; ++n) {
    const char* name = name_of(static_cast<Function>(n));
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
