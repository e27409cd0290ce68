#pragma once
// The surfaces of loads: which faces of which particles a load is on.

#include <petscsys.h>

#include <string>
#include <vector>

#include "common/model.hpp"
#include "input/geometry/free_faces.hpp"

namespace mpm {

/// Surface that a load is on, over all ranks.
struct LoadedSurface {
  long particles = 0;
  double area = 0;  // m2 (m in 2D)
  Vec3 vector{};    // m2, out of the body
};

/// Indices of the loads whose surface is found when a stage begins (from 1 on, as for a run without stages).
std::vector<int> loads_from_stage(const Config& config, int stage);

/// Adds up the faces of a load on this rank.
LoadedSurface sum_faces(const std::vector<FreeFace>& faces, int dim);

/// Adds a load's surface up over the ranks. Collective.
PetscErrorCode sum_surface(MPI_Comm comm, LoadedSurface* surface);

/// Finds the surfaces of the loads that the run begins with and gives them to `faces` of the bodies, which
/// have room for those of later stages. face_count: loads that a particle may be on. Positions are absolute;
/// on several ranks each has a part of the lattices, and all of the particles that files list. Collective.
PetscErrorCode find_load_faces(MPI_Comm comm, const Config& config, std::vector<BodyParticles>* bodies,
                               int* face_count, std::vector<LoadedSurface>* surfaces);

/// Finds the surface of one load among the particles that are in the run in its stage. Collective.
PetscErrorCode find_surface(MPI_Comm comm, const Config& config, const std::vector<BodyParticles>& bodies,
                            int load, LoadedSurface* surface);

/// The line of the log about the surface of a load.
std::string describe_surface(const Config& config, int load, const LoadedSurface& surface);

}  // namespace mpm
