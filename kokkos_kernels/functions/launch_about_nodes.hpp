#pragma once
// Launch of UpdateAboutNodes for one list of laws.

#include "data/contact_core.hpp"
#include "loops/gpu/update_about_nodes.hpp"

namespace mpm {

template <class Laws, bool HasMeans, class Space, class T>
auto update_about_nodes_of(const ContactCore<Space, T, 3>& s, double dt,
                           const Kokkos::View<int*, typename Space::memory_space>& slots, int first) {
  using Update = UpdateAboutNodes<Space, T, Laws, HasMeans>;
  return Update{update_of<typename Update::Update>(s, dt, slots, first), s.cell_means};
}

template <class Laws, bool HasMeans, class Space, class T>
void launch_about_nodes(const ContactCore<Space, T, 3>& s, double dt,
                        const Kokkos::View<int*, typename Space::memory_space>& slots,
                        const Part<Space>& part) {
  launch_large_teams(part.space, part.last - part.first,
                     update_about_nodes_of<Laws, HasMeans>(s, dt, slots, part.first));
}

/// For soil that has a law that is not light, or pores that do not drain: kernels of one law, or of all.
template <class Space, class T, int Dim>
void launch_laws_about_nodes(const ContactCore<Space, T, Dim>& s, double dt,
                             const Kokkos::View<int*, typename Space::memory_space>& slots,
                             const Part<Space>& part);

}  // namespace mpm
