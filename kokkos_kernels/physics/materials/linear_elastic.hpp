#pragma once
#include <array>
#include <limits>

#include "physics/materials/material.hpp"

namespace mpm {

/// Isotropic linear elasticity with the Jaumann rate of the Cauchy stress (hypoelastic).
template <class T>
struct LinearElastic {
  using real = T;
  static constexpr const char* k_name = "linear_elastic";
  T young, poisson;
  T lambda, shear_modulus;  // Pa, of young and poisson

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::to_array<Parameter<LinearElastic>>(
        {{"young", &LinearElastic::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
         {"poisson", &LinearElastic::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required}});
  }
  /// Called once the parameters are set.
  void prepare() {
    lambda = static_cast<T>(lame_of<double>(young, poisson));
    shear_modulus = static_cast<T>(shear_modulus_of<double>(young, poisson));
  }
  static constexpr std::array<StateVariable, 0> state() { return {}; }
  ParameterFault check() const { return {}; }
  std::array<double, 0> initial_state(const ParticleStart&) const { return {}; }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const LawState<T, 0>&) const {
    return lambda + 2 * shear_modulus;
  }
  /// Undrained shear strength [Pa]; none here.
  KOKKOS_FUNCTION T shear_strength(const LawState<T, 0>&) const { return 0; }
  /// Energy that the soil can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const LawState<T, 0>&) const {
    return elastic_energy(stress, lambda, shear_modulus);
  }
  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& stress, LawState<R, 0>&,
                              const Increment<R, T, Dim>& by) const {
    stress = rotated(stress, by.spin);
    add_elastic(stress, by.strain, lambda, shear_modulus);
  }
};

}  // namespace mpm
