#pragma once
// Forces of the soil on the parts of rigid bodies, as on tip and shaft of a pile.

#include "data/rigid_motion.hpp"
#include "data/surface.hpp"

namespace mpm {

/// The action of the soil on each part of the rigid bodies that have several, in the order of
/// SurfaceTables::parts. In the tables of forces its rows come behind those of the rigid bodies. A force
/// belongs to the part that is nearest to where it acts.
template <class Space, int Dim>
struct PartForces {
  using Memory = typename Space::memory_space;
  int count = 0;                                 // parts; 0: nobody asks for the forces on them
  Kokkos::View<int*, Memory> rigid;              // of each part
  Kokkos::View<Surface<Dim>*, Memory> surfaces;  // of the parts as given, not lengthened into each other
  Kokkos::View<Wrench<Dim>*, Memory> impulse;    // N s, N m s, since the host last took it; the moment is
                                                 // about the body's centre or its -NAME_moment_point
};

}  // namespace mpm
