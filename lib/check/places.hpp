#pragma once
// Whether nothing is in the place of something else.

#include "input/deck/report.hpp"

namespace mpm {

/// Adds a line to the report for each overlap of bodies, at the start and where later stages place some, and
/// for each load without a surface. A rank that found another mistake keeps the others from it. Collective.
PetscErrorCode check_places(MPI_Comm comm, const Config& config, InputReport& report);

/// Lines of text for loads that no surface is in the box of: errors of those that the run begins with, and
/// warnings of those of later stages, whose soil will have moved. Collective.
PetscErrorCode check_load_faces(MPI_Comm comm, const Config& config, std::vector<std::string>* errors,
                                std::vector<std::string>* warnings);

}  // namespace mpm
