#pragma once
// The particles that probes of the history take.

#include <functional>

#include "data/core.hpp"
#include "data/probe_data.hpp"

namespace mpm {

/// The particles of this rank in each region, by region and id.
template <class Space, class T, int Dim>
std::vector<ProbeParticle> particles_in(const Core<Space, T, Dim>& s,
                                        const std::vector<ProbeRegion>& regions);

/// Result of nearest_particle: the square of the distance [m2], infinite where there is no particle.
struct NearestParticle {
  double square;
  int id;
};

/// The particle of these bodies (empty: of all) nearest to a place [m from the mesh's lower corner]; of
/// equally near ones that with the lowest id. `least` makes the square of its distance the least of all
/// ranks.
template <class Space, class T, int Dim>
NearestParticle nearest_particle(const Core<Space, T, Dim>& s, const std::array<double, 3>& place,
                                 const std::vector<int>& bodies,
                                 const std::function<void(double*)>& least = {});

}  // namespace mpm
