#pragma once
// Numbers that a round of the solution for a light rigid body keeps from the round before.

#include "data/light_rigids.hpp"

namespace mpm {

/// Numbers of a body, behind the sums of all bodies: the last step of its velocity and spin, and the residual
/// before it, which is of velocities and spins too.
template <int Dim>
struct LightPast {
  static constexpr int step = 0, residual = Wrench<Dim>::size, size = 2 * Wrench<Dim>::size;
};

/// Numbers that ranks sum for so many rigids: their systems, and the number of open solutions.
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr int light_numbers(int rigids) {
  return rigids * LightTerms<Dim>::size + 1;
}

}  // namespace mpm
