#pragma once
#include "physics/materials/clay.hpp"

namespace mpm {

/// Elastic, perfectly plastic clay in undrained loading: yield at sqrt(J2) = su, radial return, so that the
/// plane-strain shear strength is su. Jaumann rate of the Cauchy stress.
template <class T>
struct VonMises : Clay<T> {
  static constexpr const char* k_name = "von_mises";
  using Clay<T>::plastic_strain;
  using Clay<T>::strength;
  using Clay<T>::young_of_particle;

  static constexpr auto parameters() {
    return joined(Clay<T>::template clay_parameters<VonMises>(),
                  YoungsModulus<T>::template growth_rows<VonMises>(),
                  Clay<T>::template strength_rows<VonMises>());
  }

  template <class R, int Dim>
  KOKKOS_FORCEINLINE_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 3>& state,
                                          const Increment<R, T, Dim>& by) const {
    const typename Clay<T>::Stiffness e = this->stiffness;
    const R basis = this->basis_of(state[strength], state[young_of_particle]);     // Pa
    const R shear_modulus = e.shear_modulus + e.shear_modulus_over_basis * basis;  // Pa
    const R su_p = this->strength_share * state[strength];                         // Pa
    s = rotated(s, by.spin);
    add_elastic(s, by.strain, R(e.lambda + e.lambda_over_basis * basis), shear_modulus);

    const R mean = mean_of(s), j2 = second_invariant(s, mean);
    const auto yields = j2 > su_p * su_p;
    if (!any_of(yields)) return;
    const R size = Kokkos::sqrt(j2), share = su_p / size;
    for (int k = 0; k < sym_size<Dim>; ++k)
      s[k] = select(yields, k < 3 ? mean + share * (s[k] - mean) : share * s[k], s[k]);
    state[plastic_strain] += select(yields, (size - su_p) / shear_modulus, R(0));
  }
};

}  // namespace mpm
