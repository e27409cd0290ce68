#pragma once
// Which rigid bodies, and sides of the mesh, may meet until the next rebuild. The host makes the list.

#include <vector>

#include "data/contact_core.hpp"

namespace mpm {

/// Lists the pairs of bodies that may touch before the next rebuild in s.pairs, with the impulses of contacts
/// that were there before. Part of
/// sort_points_and_list.
template <class Space, class T, int Dim>
void list_pairs(ContactCore<Space, T, Dim>& s);

/// Sets s.pairs.parts, from where the bodies are: bodies that overlap are parts of one.
template <class Space, class T, int Dim>
void find_parts(ContactCore<Space, T, Dim>& s);

/// The impulses of the contacts of the last step, on the host.
template <class Space, class T, int Dim>
std::vector<PairImpulse> pair_impulses(const ContactCore<Space, T, Dim>& s);

}  // namespace mpm
