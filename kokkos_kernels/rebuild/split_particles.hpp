#pragma once
// Splitting of particles (-particle_domain split): where soil is stretched so far that its particles leave
// cells between them empty, a particle becomes two. Between two steps, after locate() and before particles
// are sorted.

#include <vector>

#include "data/core.hpp"

namespace mpm {

/// A particle that is to be split: its place in memory, and its id.
struct Splitting {
  int place, id;
};

/// The particles to be split, by rising id. A particle is split where its domain's longest half length is
/// above a bound and its cell held, at the last rebuild, no more particles than it was filled with: others
/// close the gap else. It has a least mass, an eighth of that at the start.
template <class Space, class T, int Dim>
std::vector<Splitting> find_splittings(Core<Space, T, Dim>& s);

/// Splits them along the longest axes of their domains. Each keeps half of its mass and volume, and a new
/// particle, whose id is in `ids`, gets the other half, with the same velocity, stress and state. Both lie as
/// far from the place where the one particle was: the sums of mass, momentum, angular momentum and energy,
/// and the centre of mass stay. The domains of both halves together have the moments that the whole had,
/// where that was no longer than k_most_half_length.
template <class Space, class T, int Dim>
void split_particles(Core<Space, T, Dim>& s, const std::vector<Splitting>& splittings,
                     const std::vector<int>& ids);

}  // namespace mpm
