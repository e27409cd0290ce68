#pragma once
// Floors of the data of a time step: three structs, each with the one below as its base. A function takes the
// lowest floor that it needs, and is compiled again only where this floor or one below changes.

namespace mpm {

/// The mesh, the soil, the nodes, and how a step is done (data/core.hpp).
template <class Space, class T, int Dim>
struct Core;

/// Core, and the rigid bodies with their contact and joints (data/contact_core.hpp).
template <class Space, class T, int Dim>
struct ContactCore;

/// ContactCore, and what acts from outside: sides of the mesh, loads, and the energy balance of all
/// (data/state.hpp).
template <class Space, class T, int Dim>
struct State;

}  // namespace mpm
