#pragma once
// The whole grid of patches, by numbers, for what the host decides about them.

#include <array>
#include <cstdint>
#include <vector>

namespace mpm {

/// The patches of the mesh with the ring outside it, numbered as Grid::patch_of does: first direction
/// fastest, a velocity field behind the other.
struct PatchGrid {
  int dim = 2;
  std::array<int, 3> patches{1, 1, 1};
  int fields = 1;
  std::array<bool, 3> periodic{};  // the patches at both sides of a direction are neighbours

  /// Patches of one field.
  long count() const { return long(patches[0]) * patches[1] * patches[2]; }
  /// Patch n of any field as one of the first field, at the same place: patches at one place have one owner.
  long in_first_field(long n) const { return fields == 1 ? n : n % count(); }
  long number(const std::array<int, 3>& at) const {
    return (long(at[2]) * patches[1] + at[1]) * patches[0] + at[0];
  }
  std::array<int, 3> place(long n) const {
    const long row = n / patches[0], layer = row / patches[1];
    return {static_cast<int>(n - row * patches[0]), static_cast<int>(row - layer * patches[1]),
            static_cast<int>(layer)};
  }
  /// The patch within the mesh that one beyond a periodic side stands for; any other is itself.
  std::array<int, 3> in_period(std::array<int, 3> at) const {
    for (int d = 0; d < dim; ++d) {
      const int inside = patches[d] - 2;
      if (periodic[d]) at[d] += at[d] < 1 ? inside : at[d] > inside ? -inside : 0;
    }
    return at;
  }
  /// Calls f(number, offset) for the patches round n, itself included; offset is -1, 0 or 1 in each
  /// direction. In a mesh of few patches along a periodic direction one patch comes with several offsets.
  template <class F>
  void for_each_around(long n, F&& f) const {
    const long field = n - in_first_field(n);
    const std::array<int, 3> at = place(n - field);
    std::array<int, 3> offset{};
    for (offset[2] = dim == 3 ? -1 : 0; offset[2] <= (dim == 3 ? 1 : 0); ++offset[2])
      for (offset[1] = -1; offset[1] <= 1; ++offset[1])
        for (offset[0] = -1; offset[0] <= 1; ++offset[0]) {
          const std::array<int, 3> other =
              in_period({at[0] + offset[0], at[1] + offset[1], at[2] + offset[2]});
          bool in = true;
          for (int d = 0; d < 3; ++d) in = in && other[d] >= 0 && other[d] < patches[d];
          if (in) f(field + number(other), offset);
        }
  }
};

/// The rank of each patch of one field: the same table on every rank.
using Owners = std::vector<int>;

}  // namespace mpm
