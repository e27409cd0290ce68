#pragma once
#include <array>
#include <cmath>
#include <limits>

#include "physics/materials/deviator.hpp"
#include "physics/materials/elasticity.hpp"

namespace mpm {

/// Elastic-plastic metal or structure with linear isotropic hardening, on von Mises' circle: under uniaxial
/// stress it yields at `yield_stress` and then hardens by `hardening_modulus` a unit of plastic axial strain.
/// Exact radial return. Jaumann rate of the Cauchy stress.
///
/// With the engineering plastic shear strain xi the law is sqrt(J2) = yield_stress / sqrt 3 +
/// (hardening_modulus / 3) xi. The part of xi that a single-precision number cannot hold is a state variable
/// too (Kahan 1965), because the strength follows increments of xi however small they are.
template <class T>
struct J2Hardening : Elasticity<T, 2> {
  static constexpr const char* k_name = "j2_hardening";
  T yield_stress, hardening_modulus;
  T shear_yield, shear_slope;  // Pa, sqrt(J2) at first yield and its growth with xi

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    using Law = J2Hardening;
    const auto own = std::to_array<Parameter<Law>>(
        {{"yield_stress", &Law::yield_stress, "Pa", "uniaxial stress at first yield, sqrt(3 J2)", 0, 1e13,
          required},
         {"hardening_modulus", &Law::hardening_modulus, "Pa",
          "growth of the uniaxial yield stress with the plastic axial strain", 0, 1e15, 0}});
    return joined(YoungsModulus<T>::template young_rows<Law>(), own,
                  YoungsModulus<T>::template growth_rows<Law>());
  }
  /// Called once the parameters are set.
  void prepare() {
    this->prepare_elasticity();
    shear_yield = static_cast<T>(yield_stress / std::sqrt(3.0));
    shear_slope = static_cast<T>(hardening_modulus / 3.0);
  }

  enum : int { plastic_strain, remainder, young_of_particle };
  using State = LawState<T, 3>;
  static constexpr std::array<StateVariable, 3> state() {
    return {{{"plastic_strain", "-"},  // accumulated engineering plastic shear strain
             {.name = "plastic_strain_remainder", .unit = "-", .output = false},
             YoungsModulus<T>::young_variable()}};
  }
  ParameterFault check() const {
    if (yield_stress > 0 || hardening_modulus > 0) return this->young_fault();
    return {"yield_stress", "a stress in Pa greater than 0 where -NAME_hardening_modulus is 0"};
  }
  std::array<double, 3> initial_state(const ParticleStart& at) const {
    return {0, 0, this->young_at(at.height, at.own[0])};
  }
  /// sqrt(J2) [Pa] at which the particle yields.
  KOKKOS_FUNCTION T shear_strength(const State& state) const {
    return shear_yield + shear_slope * state[plastic_strain];
  }

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 3>& state,
                              const Increment<R, T, Dim>& by) const {
    s = rotated(s, by.spin);
    const R shear_modulus = this->shear_modulus_of_particle(state);
    this->add_elastic_to(s, by.strain, state);
    const R mean = mean_of(s), trial = shear_stress_of(s, mean);
    const R strength = shear_yield + shear_slope * (state[plastic_strain] + state[remainder]);
    const auto yields = trial > strength;
    if (!any_of(yields)) return;
    // trial - G x = strength + slope x
    const R grown = select(yields, (trial - strength) / (shear_modulus + shear_slope), R(0));
    const SymTensor<R, Dim> back = with_deviator(s, mean, R(1 - shear_modulus * grown / trial), mean);
    for (int k = 0; k < sym_size<Dim>; ++k) s[k] = select(yields, back[k], s[k]);
    const R before = state[plastic_strain], part = grown + state[remainder], after = before + part;
    state[plastic_strain] = select(yields, after, before);
    state[remainder] = select(yields, part - (after - before), state[remainder]);
  }
};

}  // namespace mpm
