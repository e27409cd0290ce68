#pragma once
// Rigid bodies that may touch soil at the nodes of a slot until the next rebuild.

#include "base/spaces.hpp"

namespace mpm {

/// Numbers of bodies, up to which all are near every slot: lists of so few do not pay.
inline constexpr int k_few_bodies = 8;

/// A list of bodies for each slot where a contact may be, in rising order. Tables by body and slot, such as
/// those of forces and impulses, have a place for each entry, so they grow with the bodies that are near, not
/// with all.
template <class Space>
struct NearBodies {
  using Memory = typename Space::memory_space;
  bool listed = false;                      // else all bodies are near every slot
  int width = 0;                            // entries of a list
  int widest = 0;                           // of all ranks
  Kokkos::View<int*, Memory> of;            // [slot][width], -1 behind the last one
  Kokkos::View<int*, Memory> first, place;  // entries of a body, in the order of slots: first of each body
                                            // [bodies + 1], and place in the table by contact slot
                                            // [number of slot * width + entry]
  Kokkos::View<double**, Kokkos::LayoutRight, Memory> spheres;  // m, round each body as it was placed at the
                                                                // start: middle and radius [body][4]

  /// Body number n of a slot; negative: there are no more.
  KOKKOS_INLINE_FUNCTION int body(int slot, int n) const { return listed ? of(slot * width + n) : n; }
  /// Number of a body among those of a slot, -1 where it is far.
  KOKKOS_INLINE_FUNCTION int number(int slot, int body) const {
    if (!listed) return body;
    for (int n = 0; n < width; ++n)
      if (of(slot * width + n) == body) return n;
    return -1;
  }
};

}  // namespace mpm
