#pragma once
// Start of a run: its particles, and on several ranks the owners of its patches.

#include <array>
#include <string>
#include <vector>

#include "common/snapshot.hpp"
#include "mesh/patch_grid.hpp"

namespace mpm {

/// The particles of a body or rigid before the run; positions are from the mesh's lower corner once all are
/// there. Empty columns: the body's own velocity and stress, particle_volume and particle_mass hold for all,
/// and particles without a reference height are created now.
struct BodyParticles : ParticleColumns {
  double spacing = 0;                        // m, between particles
  double particle_volume = 0;                // m3
  double least_volume = 0, most_volume = 0;  // m3, of creation, of all ranks; 0: particle_volume
  double particle_mass = 0;                  // kg; 0: density times particle_volume
  double least_mass = 0;                     // kg, where the particles differ in mass, of all ranks; else 0
  long total = 0;                            // of all ranks; 0: those here
  std::vector<int> id{};         // of each particle here, among those of all bodies; on one rank empty
                                 // where all are there
  std::vector<char> left_out{};  // [N] 1: it has an id and is not in the run; empty where all are in it
};

/// Input of a stepper: particles and owners of patches.
struct Model {
  std::array<int, 3> patches{};  // with the ring outside the mesh
  std::vector<BodyParticles> bodies, rigids;
  Owners owners;          // on several ranks: of each patch
  int face_count = 0;     // loads that a particle is on at most, of all ranks
  bool from_run = false;  // some particles are as another run left them: their stresses stay so at the start
};

}  // namespace mpm
