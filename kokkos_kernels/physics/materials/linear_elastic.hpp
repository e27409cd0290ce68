#pragma once
#include <array>
#include <limits>

#include "physics/materials/material.hpp"

namespace mpm {

/// Isotropic linear elasticity with the Jaumann rate of the Cauchy stress (hypoelastic). Young's modulus may
/// grow linearly with depth below a level; it then belongs to the particle.
template <class T>
struct LinearElastic {
  using real = T;
  static constexpr const char* k_name = "linear_elastic";
  T young, poisson, young_gradient, young_datum;
  T lambda, shear_modulus;  // Pa, of young and poisson

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::to_array<Parameter<LinearElastic>>(
        {{"young", &LinearElastic::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
         {"poisson", &LinearElastic::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required},
         {"young_gradient", &LinearElastic::young_gradient, "Pa/m", "growth of Young's modulus with depth", 0,
          1e15, 0},
         {"young_datum", &LinearElastic::young_datum, "m", "level below which Young's modulus grows", -1e9,
          1e9, 0}});
  }
  /// Called once the parameters are set.
  void prepare() {
    lambda = static_cast<T>(lame_of<double>(young, poisson));
    shear_modulus = static_cast<T>(shear_modulus_of<double>(young, poisson));
  }

  enum : int { stiffness };
  using State = LawState<T, 1>;
  static constexpr std::array<StateVariable, 1> state() {
    // Young's modulus of the particle over `young`
    return {{{.name = "stiffness", .unit = "-", .changes = false, .output = false}}};
  }
  /// Soil of one stiffness carries no state, and takes no memory for it.
  KOKKOS_FUNCTION bool carries(int) const { return young_gradient > 0; }
  ParameterFault check() const { return {}; }
  std::array<double, 1> initial_state(const ParticleStart& at) const {
    const double depth = at.height < young_datum ? young_datum - at.height : 0.0;
    return {{1 + young_gradient * depth / young}};  // nvcc drops a single pair of braces
  }
  /// Young's modulus of the particle over `young`.
  template <class R>
  KOKKOS_FUNCTION R stiffness_of(const LawState<R, 1>& state) const {
    return young_gradient > 0 ? state[stiffness] : R(1);
  }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const State& state) const {
    return (lambda + 2 * shear_modulus) * stiffness_of(state);
  }
  /// Undrained shear strength [Pa]; none here.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }
  /// Energy that the soil can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    const T share = stiffness_of(state);
    return elastic_energy(stress, share * lambda, share * shear_modulus);
  }
  template <class R, int Dim>
  KOKKOS_FORCEINLINE_FUNCTION void update(SymTensor<R, Dim>& stress, LawState<R, 1>& state,
                                          const Increment<R, T, Dim>& by) const {
    stress = rotated(stress, by.spin);
    if (young_gradient > 0) {
      const R share = state[stiffness];
      add_elastic(stress, by.strain, R(share * lambda), R(share * shear_modulus));
    } else {
      add_elastic(stress, by.strain, lambda, shear_modulus);
    }
  }
};

}  // namespace mpm
