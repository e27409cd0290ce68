#pragma once
// Surfaces of the loads that begin with a stage: what an excavation bares, and what a fill brings.

#include "data/saved_state.hpp"
#include "input/geometry/load_faces.hpp"

namespace mpm {

/// Finds the surfaces of the loads that begin with the present stage where the particles are in `state`, with
/// which the stage begins, and puts them into its fields. `fault`: why a load has no surface, or a particle
/// no room for it; empty where all is well, the same on all ranks. Collective.
PetscErrorCode find_stage_faces(MPI_Comm comm, const Config& config, SavedState* state,
                                std::vector<LoadedSurface>* surfaces, std::string* fault);

}  // namespace mpm
