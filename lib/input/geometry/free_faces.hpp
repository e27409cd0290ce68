#pragma once
// Free faces of particles in the boxes of loads.

#include <petscsys.h>

#include <span>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// The particles of a body, for a search of free faces.
struct SearchedBody {
  std::span<const double> position;  // m, absolute [dim N]; empty: the body is not in the run
  std::vector<double> width;         // m, along the axes of the body's lattice [dim N]; empty: spacing
  double spacing = 0;                // m, between particles of the lattice
  bool on_all_ranks = false;         // every rank has all particles of the body

  std::size_t count(int dim) const { return position.size() / dim; }
  Vec3 at(std::size_t p, int dim) const;
  Vec3 width_of(std::size_t p, int dim) const;
};

/// The part of a load's surface that is on one particle, as FaceTerms has it.
struct FreeFace {
  std::size_t particle = 0;  // of those of the load's body on this rank
  Vec3 vector{};             // m2, area out of the body
  double area = 0;           // m2, of a plane through the faces around, where they go in steps
  double steps = 1;          // size of the vector over the area
};

/// The numbers of a face as a particle keeps them [FacePlaces::size]; load: an index into config.loads.
std::vector<double> numbers_of(const FreeFace& face, int dim, int load);

/// Finds for each of some loads (indices into config.loads) the faces of its body's particles that no other
/// particle covers and that are in its box. On several ranks each has a part of the particles. Collective.
PetscErrorCode find_free_faces(MPI_Comm comm, const Config& config, const std::vector<SearchedBody>& bodies,
                               const std::vector<int>& loads, std::vector<std::vector<FreeFace>>* faces);

}  // namespace mpm
