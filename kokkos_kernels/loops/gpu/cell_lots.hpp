#pragma once
// A patch's particles in pieces that a team holds at once.

#include "loops/window.hpp"

namespace mpm {

/// Lots of whole cells that a team holds at once, a particle a thread.
template <class T, int cells, int threads>
struct CellLots {
  int* begin;    // first particle of each cell [cells + 1]
  T* of_thread;  // by parity of the lot: volume [m3] of each thread's particle, and volume times dilatation
                 // rate
  KOKKOS_INLINE_FUNCTION explicit CellLots(Scratch& scratch)
      : begin(scratch.take<int>(cells + 1)), of_thread(scratch.take<T>(4 * threads)) {}
  static constexpr std::size_t bytes() {
    return scratch_bytes<int>(cells + 1) + scratch_bytes<T>(4 * threads);
  }
  /// The cell after the last one of the lot that begins with cell c: one cell at least.
  KOKKOS_INLINE_FUNCTION int end(int c) const {
    int low = c + 1, high = cells;
    while (low < high) {
      const int middle = (low + high + 1) / 2;
      if (begin[middle] - begin[c] <= threads)
        low = middle;
      else
        high = middle - 1;
    }
    return low;
  }
};

}  // namespace mpm
