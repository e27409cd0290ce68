#pragma once
#include <petscsys.h>

#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Two bodies, or a body and a rigid, that are in one place.
struct Overlap {
  int body = 0;       // which is to be cut: of two bodies the larger
  std::string other;  // by what: a rigid or another body
  double volume = 0;  // m3 (m2 in 2D)
};

/// Finds the overlaps of all shapes, with what is cut out of them. Bodies that touch, within half a particle
/// (a whole one where a file lists the particles), do not overlap. Each pair whose bounds meet is looked at
/// by sample points half a particle apart, 5e7 at most, so that it takes a second at most; in more cells than
/// that an overlap of a few particles may be missed. Collective on comm: each rank looks at a part of the
/// points, and all get the same overlaps.
PetscErrorCode find_overlaps(MPI_Comm comm, const Config& config, std::vector<Overlap>* overlaps);

/// A line of text for each overlap (10 at most) that names the option which cuts. `given` tells the text of
/// an option.
std::vector<std::string> describe(const std::vector<Overlap>& overlaps, const Config& config);

}  // namespace mpm
