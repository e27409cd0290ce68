#pragma once
// Rigid bodies that are light against the soil's nodes that they touch.

#include "data/rigid_motion.hpp"

namespace mpm {

/// Numbers of the system of a light rigid body: the impulse of the soil on it [N s, N m s], and what this
/// loses by its velocity [kg, kg m, kg m2], row by row up to the diagonal.
template <int Dim>
struct LightTerms {
  static constexpr int unknowns = Wrench<Dim>::size, impulse = 0, loss = unknowns,
                       size = unknowns + unknowns * (unknowns + 1) / 2;
  /// Place of a loss by row and column, column <= row.
  KOKKOS_INLINE_FUNCTION static constexpr int loss_at(int row, int column) {
    return loss + row * (row + 1) / 2 + column;
  }
};

/// Numbers of a light body that a round of the solution keeps for the next one: the last change of its
/// velocity and spin, and the residual before this change, in m/s and rad/s too.
template <int Dim>
struct LightPast {
  static constexpr int step = 0, residual = Wrench<Dim>::size, size = 2 * Wrench<Dim>::size;
};

/// Numbers that ranks sum for so many rigids: their systems, and the number of open solutions.
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr int light_numbers(int rigids) {
  return rigids * LightTerms<Dim>::size + 1;
}

/// Velocity of a rigid body.
template <int Dim>
struct Twist {
  Vector<double, Dim> velocity;  // m/s
  AngularVector<Dim> spin;       // rad/s
};

/// Velocities of a light rigid body at the end of a step.
template <int Dim>
struct LightMotion {
  Twist<Dim> end;       // with contact, which takes the body so
  Twist<Dim> free;      // without contact with soil
  Twist<Dim> undamped;  // with contact of soil that has no local damping
  bool light;           // else contact takes the velocity at the beginning of the step
  bool open;            // the solution of this step goes on
};

/// The light rigid bodies of a run.
template <class Space, int Dim>
struct LightRigids {
  using Memory = typename Space::memory_space;
  bool in_use = false;                              // some body is light
  Kokkos::View<LightMotion<Dim>*, Memory> motions;  // [rigids]
  Kokkos::View<double*, Memory> of_slots;           // [contact slot][near body][LightTerms]
  Kokkos::View<double*, Memory> sums;               // light_numbers(rigids), and [rigids][LightPast]
};

}  // namespace mpm
