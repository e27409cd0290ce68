#pragma once
// Domains follow the soil at a rebuild, before the particles' new places are found.

#include "functions/follow_soil.hpp"
#include "parallel/decomposition.hpp"

namespace mpm {

/// Deforms the domains of particles with their soil, where the run asks for it. Before locate(), or between
/// two steps, whose sums of the next step it drops. ranks: null on one rank. Collective.
template <class Space, class T, int Dim>
PetscErrorCode follow_soil(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks = nullptr) {
  PetscFunctionBeginUser;
  if (!s.soil.points.has_domain) PetscFunctionReturn(PETSC_SUCCESS);
  if (ranks) ranks->drop_ahead();
  sum_drift(s);
  if (ranks) {
    PetscCall(ranks->add_field(s, s.nodes.centre, When::between_steps));
    PetscCall(ranks->add_field(s, s.nodes.drift, When::between_steps));
  }
  stretch_domains(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
