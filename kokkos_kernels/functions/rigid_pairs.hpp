#pragma once
// Contact between rigid bodies in a step.

#include <vector>

#include "data/contact_core.hpp"

namespace mpm {

/// Part of 6, before move_rigids, where s.pairs is in use: leaves in s.pairs.actions what rigid bodies and
/// sides of the mesh that touch do to each rigid body in a step of dt [s]. The forces of the soil are summed.
template <class Space, class T, int Dim>
void contact_of_rigids(ContactCore<Space, T, Dim>& s, double dt, const Space& stream);

/// The actions on each rigid body, whose impulses begin anew.
template <class Space, class T, int Dim>
std::vector<PairAction<Dim>> take_pair_actions(ContactCore<Space, T, Dim>& s);

}  // namespace mpm
