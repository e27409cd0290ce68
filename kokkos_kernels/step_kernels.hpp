#pragma once
// The functions of a time step beside the interpolation to nodes; each is one function of the paper.

#include "spaces.hpp"
#include "state.hpp"

namespace mpm {

/// 1. Sets the nodal sums to zero.
template <class Space, class T, int Dim>
void reset_nodes(State<Space, T, Dim>& s);

/// 4. Nodal velocities and accelerations, boundary conditions, contact (Eqs (6), (8)-(10)). Leaves the
/// contact forces in s.sums. dt [s].
template <class Space, class T, int Dim>
void update_nodes(State<Space, T, Dim>& s, double dt);

/// 5. Strains, stresses and material properties; velocities and positions of the soil (Eqs (11)-(13)). Leaves
/// the furthest movement of a particle in s.control. dt [s].
template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt);

/// 6. Moves the rigid bodies (Eq. 7), counts the step, and adds what any point can have moved to the bound.
/// dt [s].
template <class Space, class T, int Dim>
void move_rigids(State<Space, T, Dim>& s, double dt);

/// Copy of the control block on the host. Waits for the steps before it.
template <class Space, class T, int Dim>
Control look(const State<Space, T, Dim>& s);

/// Sets the count of steps since the last look to zero.
template <class Space, class T, int Dim>
void restart_count(State<Space, T, Dim>& s);

}  // namespace mpm
