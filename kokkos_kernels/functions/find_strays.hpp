#pragma once
// Strays: soil that has left the rest of the soil.

#include "data/core.hpp"

namespace mpm {

/// Finds the particles that are alone, from the nodes' masses once those of all ranks are there, for as long
/// as the lists hold; sort_and_list() has marked none. With StrayRule::stop one is a fault.
template <class Space, class T, int Dim>
void mark_strays(Core<Space, T, Dim>& s, const Space& stream);

/// Adds the particles that locate() has found to leave the run, those without an address, to Strays::lost.
template <class Space, class T, int Dim>
void note_lost(Core<Space, T, Dim>& s);

}  // namespace mpm
