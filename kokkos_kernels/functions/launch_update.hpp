#pragma once
// Launch of UpdateParticles for one list of laws.

#include "data/contact_core.hpp"
#include "loops/gpu/patch_update.hpp"

namespace mpm {

template <bool Sums, PatchKind kind, class Laws, ParticleDomain domain, class Space, class T, int Dim>
void launch_update(const ContactCore<Space, T, Dim>& s, double dt,
                   const Kokkos::View<int*, typename Space::memory_space>& slots, const Part<Space>& part) {
  using Update = UpdateParticles<Space, T, Dim, Sums, kind, Laws, domain>;
  const int teams = part.last - part.first;
  if (teams == 0) return;
  Kokkos::parallel_for("mpm::update_particles",
                       light(typename Update::Team(part.space, teams, Update::threads)
                                 .set_scratch_size(0, Kokkos::PerTeam(Update::bytes() + k_scratch_slack))),
                       update_of<Update>(s, dt, slots, part.first));
}

/// For common patches: launches the kernel of the one law that all soil has, if there is one. It is a kernel
/// that sums ahead where `sums`.
template <class Space, class T, int Dim>
bool launch_single_law(const ContactCore<Space, T, Dim>& s, double dt, bool sums,
                       const Kokkos::View<int*, typename Space::memory_space>& slots,
                       const Part<Space>& part);

}  // namespace mpm
