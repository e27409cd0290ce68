#pragma once
// The velocity of the nodes, for what a run shows of it. FLIP's particles carry noise that no node feels, so
// that their own velocities neither tell rest from motion nor make a picture.
//
// The nodal velocity here is Eq. (6), momentum over mass, without walls and contact. The sums at the nodes
// must be those of the particles where they are now: sum_present_soil (lib/step/step.hpp).

#include <vector>

#include "spaces.hpp"
#include "state.hpp"

namespace mpm {

/// Largest speed of a node that holds soil, one above the mass cut [m/s].
template <class Space, class T, int Dim>
double fastest_node(const State<Space, T, Dim>& s);

/// Nodal velocities interpolated to the particles, sum S v_i [m/s], by id: [Dim N].
template <class Space, class T, int Dim>
std::vector<double> grid_velocities(const State<Space, T, Dim>& s);

}  // namespace mpm
