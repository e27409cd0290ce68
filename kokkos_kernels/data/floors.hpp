#pragma once
// What a time step works on, in three floors: a function takes the lowest one that it needs, and is compiled
// anew only for what lies in it.

namespace mpm {

/// The mesh, the soil, the nodes, and how a step is done (data/core.hpp).
template <class Space, class T, int Dim>
struct Core;

/// Core, and the rigid bodies with their contact (data/contact_core.hpp).
template <class Space, class T, int Dim>
struct ContactCore;

/// ContactCore, and what acts from outside: sides of the mesh, loads, and the energy balance of all
/// (data/state.hpp).
template <class Space, class T, int Dim>
struct State;

}  // namespace mpm
