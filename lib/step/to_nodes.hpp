#pragma once
// From particles to nodes: functions 2 and 3 of a step, and those that some runs have beside them.

#include "data/state.hpp"
#include "functions/rayleigh.hpp"
#include "parallel/decomposition.hpp"

namespace mpm {

/// Function 2: mass and normal direction to the nodes, of each rigid body whose surface does not give them.
/// They may be there already.
template <class Space, class T, int Dim>
void rigids_to_nodes(const State<Space, T, Dim>& s, const Space& stream);

/// Function 3: the soil's mass, momentum and internal force to the nodes, and its boundary where a contact
/// needs it, unless the caller sums the boundary. Both may be there already. Of all the soil, or of a part of
/// it.
template <class Space, class T, int Dim>
void soil_to_nodes(const State<Space, T, Dim>& s, const Space& stream, bool boundary = true);
template <class Space, class T, int Dim>
void soil_to_nodes(const State<Space, T, Dim>& s, const Part<Space>& part);

/// The weight of the water that the soil displaces, to the forces at the nodes. Of this rank's soil: the sum
/// over ranks is that of the forces.
template <class Space, class T, int Dim>
void buoyancy_to_nodes(State<Space, T, Dim>& s);

/// Loads on surfaces to the nodes, and to the forces there. Of this rank's soil, likewise.
template <class Space, class T, int Dim>
void loads_to_nodes(State<Space, T, Dim>& s);

/// Rayleigh damping to the forces at the nodes, whose sums are those of all ranks. The sums of the soil with
/// viscous stresses hold its mass and momentum once more, which nothing asks for.
template <class Space, class T, int Dim>
PetscErrorCode rayleigh_to_nodes(State<Space, T, Dim>& s, Rayleigh<Space, T, Dim>& by,
                                 Decomposition<Space, T, Dim>* ranks);

/// Sums that contact needs in some runs at its nodes: the soil's strength, how the soil of each of several
/// velocity fields lies round a node, and, where `boundary`, the soil's boundary. Function 5 may have made
/// them already. ranks: null where this is the only one; else `stream` is the state's own.
template <class Space, class T, int Dim>
PetscErrorCode contacts_to_nodes(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks,
                                 const Space& stream, bool boundary = false);

/// Sums FlowTerms at the nodes, of all ranks, where water flows in pores.
template <class Space, class T, int Dim>
PetscErrorCode flow_to_nodes(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks);

/// The soil's nodal sums as it is now, for what is measured between two steps; the next step makes its own.
/// The lists hold, as they do for that step: s.control must not be paused.
template <class Space, class T, int Dim>
void sum_present_soil(State<Space, T, Dim>& s);

/// All of the soil's nodal sums as it is now, with buoyancy and loads, of all ranks: the forces but for those
/// of contact.
template <class Space, class T, int Dim>
PetscErrorCode sum_present_forces(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks);

/// The velocities of the soil's particles, where XPIC or APIC is chosen: a part of function 5.
template <class Space, class T, int Dim>
PetscErrorCode update_velocities(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks);

}  // namespace mpm
