#pragma once
// Merging of particles (-particle_domain split): where soil that was stretched, and whose particles were
// split, is pressed together again, two particles become one. Between two steps, after locate() and before
// particles are split and sorted.

#include "data/core.hpp"

namespace mpm {

/// Merges pieces of particles in cells that held, at the last rebuild, more than twice as many particles as
/// fill a cell at the start. A pair is of one body, both together have no more mass than a particle at the
/// start, and the domain of both is far from being split again. In each cell the pair whose common domain is
/// smallest comes first. The particle with the lower id gets the mass, momentum, volume and centre of mass of
/// both, the moments of both domains, and the means of stress and state by volume; the other gets no address,
/// so that the sort leaves it out. Strays::lost counts both, and the kinetic energy of the motion of one
/// against the other, which is gone.
template <class Space, class T, int Dim>
void merge_particles(Core<Space, T, Dim>& s);

}  // namespace mpm
