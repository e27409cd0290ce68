#pragma once
// Whether nothing is in the place of something else.

#include "input/options.hpp"

namespace mpm {

/// Adds a line to the report for each overlap of bodies, at the start and where later stages place some, and
/// for each load without a surface. A rank that found another mistake keeps the others from it. Collective.
PetscErrorCode check_places(MPI_Comm comm, const Config& config, InputReport& report);

}  // namespace mpm
