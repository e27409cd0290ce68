#pragma once
// Slots where a contact may be.

#include "data/near_bodies.hpp"
#include "data/particles.hpp"

namespace mpm {

/// Slots whose particles reach a node that a rigid may touch until the next rebuild, and the sums that
/// contact takes there.
template <class Space>
struct ContactSlots {
  using Memory = typename Space::memory_space;
  Kokkos::View<int*, Memory> place;  // by slot: its place in `slots`, from 1 on; 0: it has no contact
  Kokkos::View<int*, Memory> slots;
  int count = 0;           // of `slots`
  NearBodies<Space> near;  // by slot
  Windows<Space> boundary, strength,
      cloud;  // of the soil, BoundaryTerms, StrengthTerms and CloudTerms, in these slots
  Kokkos::View<double*, Memory> forces;  // N, [turn of a persistent step, else 0][of slots][near body, then
                                         // part][of Wrench], of the soil on the rigids
};

/// Places of slots among those where a contact may be, as ContactSlots::place.
template <class Space>
using ContactPlaces = decltype(ContactSlots<Space>::place);

}  // namespace mpm
