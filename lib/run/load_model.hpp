#pragma once
// Mesh and particles of a run.

#include "common/model.hpp"
#include "run/job.hpp"

namespace mpm {

/// Owners of patches, and the particles of all bodies and rigids, from the options. Collective.
PetscErrorCode load_model(Job& job, Model* model);

/// Particles that a file lists, read again after they were checked with the options. `from_run` is set where
/// another run has left them.
PetscErrorCode load_file(Job& job, const BodyConfig& body, BodyParticles* particles, bool* from_run);

}  // namespace mpm
