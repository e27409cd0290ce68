#pragma once
// Soil that has left the others: particles that hardly any other is in reach of, and those that left the run.

#include <vector>

#include "base/choices.hpp"
#include "base/spaces.hpp"
#include "data/nodes.hpp"

namespace mpm {

/// Soil of one body that left the run through a free side or was removed, on this rank, since the start.
struct Lost {
  double count = 0, mass = 0, kinetic_energy = 0;  // -, kg, J
  double momentum[3] = {};                         // kg m/s
  double merged = 0, merged_energy = 0;            // particles that others took up; J, of the motion of both
  double corrected = 0, raised = 0;  // J, kinetic and of height: what the position correction has added
};

/// Least and most volume of a particle over a volume at the start: in each step over that of the smallest and
/// that of the largest particle, at a rebuild over the particle's own (limit_volumes). A particle of twice
/// its volume is as stiff as two with half its mass: beyond it the time step is not stable any more.
inline constexpr double k_least_volume = 0.2, k_most_volume = 2;

/// Whether the particles of a cell, by its number, are alone. alone: Strays::alone
template <class Alone>
KOKKOS_INLINE_FUNCTION bool is_alone(const Alone& alone, int cell) {
  static_assert(Patch<2>::cells == 64 && Patch<3>::cells == 64, "a bit a cell");
  return (alone(cell / 64) >> (cell % 64) & 1) != 0;
}

/// Which particles are alone, and what has left.
template <class Space>
struct Strays {
  using Memory = typename Space::memory_space;
  StrayRule rule = StrayRule::keep;
  Kokkos::View<std::uint64_t*, Memory> alone;  // by slot, a bit a cell: its particles are alone
  bool known = false;                          // `alone` is of the present lists
  Kokkos::View<int*, Memory> put_back;         // by body: particles that were put back at a wall
  double least_volume = 0, most_volume = 0;    // m3, of any particle
  /// By body: a particle's volume over its mass at the start [m3/kg], 0 where a file gave both. Empty where
  /// all particles have the same volume at the start and do not split.
  Kokkos::View<double*, Memory> start_volume;
  std::vector<Lost> lost;  // by body
};

}  // namespace mpm
