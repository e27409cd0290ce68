#pragma once
// The slots that hold soil, by what a GPU's update of the particles has to do there.

#include <vector>

#include "data/particles.hpp"

namespace mpm {

/// Bins::active_slots in another order, for function 5 on a device: of each part of them the common patches
/// first (PatchKind), then the others. Valid until the next rebuild.
template <class Space>
struct SplitPatches {
  struct Range {
    int first, near, middle, last;  // common [first, middle), of which [first, near) give to contact sums
                                    // that are wanted early; others [middle, last)
  };
  Kokkos::View<int*, typename Space::memory_space> slots;
  std::vector<Range> parts;  // border and inner, or one part; none: not made yet

  /// Whether some of the parts together are this one.
  bool holds(const Part<Space>& part) const {
    int found = 0;
    for (const Range& of : parts)
      if (of.first >= part.first && of.last <= part.last) found += of.last - of.first;
    return !parts.empty() && found == part.last - part.first;
  }
  /// Whether there are patches that are launched first, on a stream of their own.
  bool has_early() const {
    for (const Range& of : parts)
      if (of.first < of.near || of.middle < of.last) return true;
    return false;
  }
};

}  // namespace mpm
