#pragma once
// Function 5 on a device, with functions 1 and 3 of the next step, where bins are about nodes.

#include "data/contact_core.hpp"

namespace mpm {

/// As update_particles, for some of `slots`, all of them common patches (PatchKind) without a boundary to
/// sum. dt [s].
template <class Space, class T, int Dim>
void update_about_nodes(const ContactCore<Space, T, Dim>& s, double dt,
                        const Kokkos::View<int*, typename Space::memory_space>& slots,
                        const Part<Space>& part);

/// Function 3 of the next step for the other slots, after their particles have moved.
template <class Space, class T, int Dim>
void sum_others(const ContactCore<Space, T, Dim>& s,
                const Kokkos::View<int*, typename Space::memory_space>& slots, const Part<Space>& part);

/// The mean dilatation rate of each cell [1/s], of the particles that were in it at the last rebuild: their
/// sums in Core::cell_means, and the mean for each particle of the patches that are not common in
/// dilatations_of(). After function 4.
template <class Space, class T, int Dim>
void sum_dilatations(const ContactCore<Space, T, Dim>& s);

}  // namespace mpm
