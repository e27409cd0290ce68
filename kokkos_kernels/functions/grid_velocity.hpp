#pragma once
// The velocity with which the nodes move the particles, for what a run shows. FLIP's particles carry noise
// that no node feels, so their own velocities do not distinguish rest from motion and make no clear picture.
// Velocities of light nodes do not either, because such a node follows one particle.
//
// The velocity of a particle is sum S v_i with the nodal velocity of Eq. (6), momentum over mass, without
// walls and contact. The sums at the nodes must be those of the particles where they are now:
// sum_present_soil (lib/step/to_nodes.hpp).

#include <vector>

#include "base/spaces.hpp"
#include "data/core.hpp"

namespace mpm {

/// Largest speed of a body's particles, by the nodes [m/s].
template <class Space, class T, int Dim>
double largest_grid_speed(const Core<Space, T, Dim>& s, int body);

/// Velocity of every particle of this rank, by the nodes [m/s], in this order of the particles: [Dim N].
template <class Space, class T, int Dim>
std::vector<double> grid_velocities(const Core<Space, T, Dim>& s, const std::vector<int>& order);

}  // namespace mpm
