#pragma once
// The surfaces of loads: which faces of which particles a load is on at the start.

#include <petscsys.h>

#include <string>
#include <vector>

#include "common/model.hpp"

namespace mpm {

/// What a load is on, of all ranks.
struct LoadedSurface {
  long particles = 0;
  double area = 0;  // m2 (m in 2D)
  Vec3 vector{};    // m2, out of the body
};

/// Finds the faces of particles that no other particle covers and that are in the boxes of the loads, and
/// gives them to `faces` of the bodies. face_count: loads that a particle is on at most. Positions are
/// absolute; on several ranks each has a part of the lattices, and all of the particles that files list.
/// Collective.
PetscErrorCode find_load_faces(MPI_Comm comm, const Config& config, std::vector<BodyParticles>* bodies,
                               int* face_count, std::vector<LoadedSurface>* surfaces);

/// Lines of text for loads that no surface is in the box of. Collective.
PetscErrorCode check_load_faces(MPI_Comm comm, const Config& config, std::vector<std::string>* lines);

}  // namespace mpm
