#pragma once
// The correction of positions at a rebuild, after lists were made.

#include "functions/position_correction.hpp"
#include "loops/interpolation.hpp"
#include "step/to_nodes.hpp"

namespace mpm {

/// The volume and the boundary of the soil at the nodes, of this rank: as soil_to_nodes makes them near
/// rigids, but everywhere. Bodies of revolution are not corrected.
template <ParticleDomain domain, class Space, class T, int Dim>
void volume_to_nodes(const State<Space, T, Dim>& s, const FillField<Space, T, Dim>& fill) {
  const Kokkos::View<int*, typename Space::memory_space> everywhere(
      Kokkos::view_alloc("mpm::everywhere", Kokkos::WithoutInitializing), s.patches.slots);
  Kokkos::deep_copy(s.space, everywhere, 1);
  auto it = interpolation_of<BoundarySource<Space, T, Dim, domain>>(
      s, s.soil.bins, {s.soil.points, s.grid.inv_spacing, everywhere}, fill, s.space);
  it.windows = s.soil.bins.windows;  // those of boundaries are for patches near rigids alone
  particle_to_node(s.p2g.strategy, it);
}

/// The particles' shares to the nodes, of this rank.
template <class Space, class T, int Dim>
void shares_to_nodes(const State<Space, T, Dim>& s) {
  Kokkos::deep_copy(s.space, s.nodes.shares, T(0));
  interpolate<ValueSource<Space, T, Dim, Dim, Kind::geometry>>(s, s.p2g.strategy, s.soil.bins,
                                                               {s.soil.points, shares_of(s)}, s.nodes.shares);
}

template <ParticleDomain domain, class Space, class T, int Dim>
PetscErrorCode correct_positions_for(State<Space, T, Dim>& s, double elapsed,
                                     Decomposition<Space, T, Dim>* ranks) {
  PetscFunctionBeginUser;
  sum_present_soil(s);
  if (ranks) PetscCall(ranks->add_present_soil(s));
  const FillField<Space, T, Dim> fill("mpm::fill", s.patches.node_count());
  volume_to_nodes<domain>(s, fill);
  if (ranks) PetscCall(ranks->add_field(s, fill, When::between_steps));
  compare_volumes(s, fill);
  find_shifts(s, fill, elapsed);
  shares_to_nodes(s);
  if (ranks) PetscCall(ranks->add_field(s, s.nodes.shares, When::between_steps));
  apply_shifts(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Moves particles of soil that flows towards an even density, where the run asks for it. elapsed: time since
/// the correction before [s]. ranks: null on one rank. Collective.
template <class Space, class T, int Dim>
PetscErrorCode correct_positions(State<Space, T, Dim>& s, double elapsed,
                                 Decomposition<Space, T, Dim>* ranks = nullptr) {
  PetscFunctionBeginUser;
  if (!s.correction.on) PetscFunctionReturn(PETSC_SUCCESS);
  if (s.soil.points.has_domain)
    PetscCall(correct_positions_for<ParticleDomain::stretch>(s, elapsed, ranks));
  else
    PetscCall(correct_positions_for<ParticleDomain::fixed>(s, elapsed, ranks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
