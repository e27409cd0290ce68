#pragma once
// The works of a step, for the energy balance (-output_energy on). Steps are then separate, as plan_step
// chooses them, so that the nodal sums are there when these functions look.

#include "base/spaces.hpp"
#include "data/state.hpp"

namespace mpm {

/// Makes room for the works and sets them to zero. Before the first step.
template <class Space, class T, int Dim>
void begin_works(State<Space, T, Dim>& s);

/// Between functions 4 and 5 of a step of dt [s]: adds the works at the nodes, and keeps what add_stress_work
/// and add_rigid_work need of the time before the step.
template <class Space, class T, int Dim>
void add_node_works(State<Space, T, Dim>& s, double dt);

/// After function 5: adds the work of the mean stress of the step on its strain.
template <class Space, class T, int Dim>
void add_stress_work(State<Space, T, Dim>& s);

/// After function 6: adds the work of the rigids on the soil. counts: s.rigid_force are forces that this rank
/// answers for.
template <class Space, class T, int Dim>
void add_rigid_work(State<Space, T, Dim>& s, bool counts);

}  // namespace mpm
