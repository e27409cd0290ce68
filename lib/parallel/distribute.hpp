#pragma once
// The particles of a model, each on the rank that owns its patch.

#include "common/model.hpp"
#include "mesh/background.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Gives every patch an owner (Model::owners) and every rank the particles of its patches. Each has made its
/// part of every lattice (LatticePart), and has all particles of a file. Particles get the id that they would
/// have on one rank. Rigids stay whole. Collective; does nothing on one rank.
PetscErrorCode distribute(MPI_Comm comm, const Config& config, const BackgroundMesh& mesh, Model* model);

}  // namespace mpm
