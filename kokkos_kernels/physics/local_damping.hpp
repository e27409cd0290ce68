#pragma once
// Local damping: a force against the velocity, in proportion to the force that is out of balance.

#include "base/lanes.hpp"
#include "base/types.hpp"

namespace mpm {

/// Velocity over its change in a step below which local damping leaves it alone: that small it is round-off,
/// whose sign differs with the order of sums.
template <class T>
inline constexpr T k_still = T(1e-6);

/// Share of the largest component of a velocity below which another one is round-off.
template <class T>
inline constexpr T k_beside = sizeof(T) == sizeof(double) ? T(1e-10) : T(1e-5);

/// Deceleration [m/s2] where the acceleration is a and the velocity before the step of length dt [s] was v,
/// by number or by lane; factor: -damping. T: precision of the soil's forces.
template <class T, class R, int Dim>
KOKKOS_FORCEINLINE_FUNCTION Vector<R, Dim> local_damping(RealOf<R> factor, RealOf<R> dt,
                                                         const Vector<R, Dim>& a, const Vector<R, Dim>& v) {
  using Real = RealOf<R>;
  Vector<R, Dim> brake;
  for (int d = 0; d < Dim; ++d) brake[d] = R(0);
  if (!(factor > 0)) return brake;
  R fastest = Kokkos::fabs(v[0]);
  for (int d = 1; d < Dim; ++d) fastest = Kokkos::fmax(fastest, Kokkos::fabs(v[d]));
  for (int d = 0; d < Dim; ++d) {
    const R size = Kokkos::fabs(a[d]),
            still = Kokkos::fmax(Real(k_still<T>) * dt * size, Real(k_beside<T>) * fastest);
    brake[d] = factor * size * select(v[d] > still, R(1), select(v[d] < -still, R(-1), R(0)));
  }
  return brake;
}

}  // namespace mpm
