#pragma once
// What a run starts from: its particles, and on several ranks the owners of its patches.

#include <array>
#include <string>
#include <vector>

#include "common/snapshot.hpp"
#include "mesh/patch_grid.hpp"

namespace mpm {

/// The particles of a body or rigid before the run.
struct BodyParticles {
  std::vector<double> position;              // m from the mesh's lower corner, dim components each
  double spacing = 0;                        // m, between particles
  double particle_volume = 0;                // m3
  std::vector<double> velocity;              // m/s [dim N], or empty where the body's own holds for all
  std::vector<double> stress;                // Pa [4 N in 2D, 6 N in 3D], likewise
  std::vector<StateField> state;             // state variables that a file gives
  std::vector<StateField> own_parameters;    // of the law, that a field or a file gives
  std::vector<double> volume;                // m3 [N], or empty where particle_volume holds for all
  std::vector<double> mass;                  // kg [N], or empty where particle_mass holds for all
  double least_volume = 0, most_volume = 0;  // m3, of creation, of all ranks; 0: particle_volume
  double particle_mass = 0;                  // kg; 0: density times particle_volume
  double least_mass = 0;                     // kg, where the particles differ in mass, of all ranks; else 0
  std::vector<double> reference_height;  // m, absolute, of creation [N]; or empty where they are just created
  long total = 0;                        // of all ranks; 0: those above
  std::vector<int> id;         // of each particle here, among those of all bodies; on one rank empty
                               // where all are there
  std::vector<char> left_out;  // [N] 1: it has an id and is not in the run; empty where all are in it
  std::vector<double> velocity_gradient;  // m/s a cell [dim^2 N], where the neighbours may be on other ranks
  std::vector<double>
      faces;  // surfaces of loads [faces_width N], as FaceTerms has them; empty: there are none
  std::vector<double> domain;  // cells2, moments of domains that stretch [dim (dim + 1) / 2 N], or empty
};

/// Everything that a stepper starts from.
struct Model {
  std::array<int, 3> patches{};  // with the ring outside the mesh
  std::vector<BodyParticles> bodies, rigids;
  Owners owners;          // on several ranks: of each patch
  int face_count = 0;     // loads that a particle is on at most, of all ranks
  bool from_run = false;  // some particles are as another run left them: their stresses stay so at the start
};

}  // namespace mpm
