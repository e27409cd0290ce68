#pragma once
// Contact at sites, in a step and for what is measured between two (docs/method.md, "Contact at sites").

#include "data/state.hpp"
#include "parallel/decomposition.hpp"

namespace mpm {

/// Part of function 4, behind update_nodes, before the nodal sums are cleared. dt: s. ranks: null on one
/// rank.
template <class Space, class T, int Dim>
PetscErrorCode contact_at_sites(State<Space, T, Dim>& s, double dt, Decomposition<Space, T, Dim>* ranks);

/// Sums the forces of the last step at the sites in s.at_sites.sums, between two steps.
template <class Space, class T, int Dim>
PetscErrorCode sum_site_forces(State<Space, T, Dim>& s, double dt, Decomposition<Space, T, Dim>* ranks);

}  // namespace mpm
