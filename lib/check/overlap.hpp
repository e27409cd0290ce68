#pragma once
#include <petscsys.h>

#include <array>
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Two bodies, or a body and a rigid, that are in one place.
struct Overlap {
  int body = 0;               // which is to be cut: of two bodies the larger
  std::string other;          // by what: a rigid or another body
  double volume = 0;          // m3 (m2 in 2D)
  std::array<int, 2> pair{};  // the two, by numbers: bodies first, then rigids
};

/// Finds the overlaps of all shapes, with what is cut out of them. Bodies that touch, within half a particle
/// (a whole one where a file lists the particles), do not overlap. Each pair whose bounds meet is tested at
/// sample points half a particle apart, 5e7 at most, so that it takes a second at most; in more cells than
/// that an overlap of a few particles may be missed. Collective on comm: each rank tests a part of the
/// points, and all get the same overlaps.
PetscErrorCode find_overlaps(MPI_Comm comm, const Config& config, std::vector<Overlap>* overlaps);

/// Finds the overlaps that a stage after the first will have and that follow from the start: overlaps of the
/// bodies that it places with each other and with rigid bodies that have not moved by then. `fixed`: of each
/// rigid, whether it has not.
PetscErrorCode find_overlaps_of_placed(MPI_Comm comm, const Config& config, const std::vector<char>& fixed,
                                       std::vector<Overlap>* overlaps);

/// Bodies and rigids as they are now: of each that is in the run, the places of its particles near what the
/// stage places [m, packed by dim], and its displacement [m].
struct Present {
  std::vector<std::vector<double>> soil;
  std::vector<Vec3> rigids;
};

/// Finds the overlaps when a stage begins, of the bodies that it places with all that is there.
PetscErrorCode find_overlaps_at_stage(MPI_Comm comm, const Config& config, const Present& present,
                                      std::vector<Overlap>* overlaps);

/// Which of the particles of a body [m, packed by dim] its -NAME_cut_out takes out when the stage begins: of
/// a body that the stage places, those where others are; of another body, those where placed ones are.
std::vector<char> cut_at_stage(const Config& config, int body, const Present& present,
                               const std::vector<double>& position);

/// The overlaps that are found when a stage begins, in one line.
std::string describe_at_stage(const std::vector<Overlap>& overlaps, const Config& config);

/// A line of text for each overlap (10 at most) that names the option which cuts. `given` returns the text of
/// an option.
std::vector<std::string> describe(const std::vector<Overlap>& overlaps, const Config& config);

}  // namespace mpm
