#pragma once
// Whether the machine and the program allow a run.

#include "input/deck/report.hpp"

namespace mpm {

/// Adds a line to the report where this program has no GPU, precision or dimension for the run, or the mesh
/// has too many patches. A dry run for a GPU goes to the processor instead, so that a deck for a GPU can be
/// checked on a login node. Collective.
PetscErrorCode check_machine(MPI_Comm comm, Config& config, InputReport& report);

}  // namespace mpm
