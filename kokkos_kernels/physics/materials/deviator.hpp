#pragma once
// The deviator of a stress: its size, and a stress that is put together of a mean stress and a deviator.

#include "physics/materials/material.hpp"

namespace mpm {

/// sqrt(J2) [Pa] of a stress with this mean stress [Pa], J2 = s : s / 2 of the deviator s. In simple shear it
/// is the shear stress.
template <class R, int Dim>
KOKKOS_INLINE_FUNCTION R shear_stress_of(const SymTensor<R, Dim>& stress, const R& mean) {
  return Kokkos::sqrt(second_invariant(stress, mean));
}

/// Adds 2 G e' [Pa] to a stress, with the deviator e' of the strain e whose trace is `dilatation`. The mean
/// stress stays.
template <class R, class T, int Dim>
KOKKOS_INLINE_FUNCTION void add_shear(SymTensor<R, Dim>& stress, const SymTensor<R, Dim>& strain,
                                      const R& dilatation, const T& shear_modulus) {
  const R third = dilatation * T(1.0 / 3);
  for (int k = 0; k < sym_size<Dim>; ++k)
    stress[k] += 2 * shear_modulus * (k < 3 ? strain[k] - third : strain[k]);
}

/// The stress with `share` of the deviator, and with the mean stress `to` [Pa] in the place of `from` [Pa].
template <class R, int Dim>
KOKKOS_INLINE_FUNCTION SymTensor<R, Dim> with_deviator(const SymTensor<R, Dim>& stress, const R& from,
                                                       const R& share, const R& to) {
  SymTensor<R, Dim> r;
  for (int k = 0; k < sym_size<Dim>; ++k) r[k] = k < 3 ? to + share * (stress[k] - from) : share * stress[k];
  return r;
}

}  // namespace mpm
