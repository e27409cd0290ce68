#pragma once
// The whole grid of patches, by numbers, for what the host decides about them.

#include <array>
#include <cstdint>
#include <vector>

namespace mpm {

/// The patches of the mesh with the ring outside it, numbered as Grid::patch_of does: first direction
/// fastest.
struct PatchGrid {
  int dim = 2;
  std::array<int, 3> patches{1, 1, 1};

  long count() const { return long(patches[0]) * patches[1] * patches[2]; }
  long number(const std::array<int, 3>& at) const {
    return (long(at[2]) * patches[1] + at[1]) * patches[0] + at[0];
  }
  std::array<int, 3> place(long n) const {
    const long row = n / patches[0], layer = row / patches[1];
    return {static_cast<int>(n - row * patches[0]), static_cast<int>(row - layer * patches[1]),
            static_cast<int>(layer)};
  }
  /// Calls f(number, offset) for the patches round n, itself included; offset is -1, 0 or 1 in each
  /// direction.
  template <class F>
  void for_each_around(long n, F&& f) const {
    const std::array<int, 3> at = place(n);
    std::array<int, 3> offset{};
    for (offset[2] = dim == 3 ? -1 : 0; offset[2] <= (dim == 3 ? 1 : 0); ++offset[2])
      for (offset[1] = -1; offset[1] <= 1; ++offset[1])
        for (offset[0] = -1; offset[0] <= 1; ++offset[0]) {
          const std::array<int, 3> other{at[0] + offset[0], at[1] + offset[1], at[2] + offset[2]};
          bool in = true;
          for (int d = 0; d < 3; ++d) in = in && other[d] >= 0 && other[d] < patches[d];
          if (in) f(number(other), offset);
        }
  }
};

/// The rank of each patch of the whole grid: the same table on every rank.
using Owners = std::vector<int>;

}  // namespace mpm
