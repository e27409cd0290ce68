#pragma once
// The surfaces of loads: which faces of which particles a load is on.

#include <petscsys.h>

#include <string>
#include <vector>

#include "common/model.hpp"
#include "input/free_faces.hpp"

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

/// Lines of text for loads that no surface is in the box of: errors of those that the run begins with, and
/// warnings of those of later stages, whose soil will have moved. Collective.
PetscErrorCode check_load_faces(MPI_Comm comm, const Config& config, std::vector<std::string>* errors,
                                std::vector<std::string>* warnings);

/// The line of the log about the surface of a load.
std::string describe_surface(const Config& config, int load, const LoadedSurface& surface);

}  // namespace mpm
