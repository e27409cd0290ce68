#pragma once
#include <array>
#include <limits>

#include "physics/materials/material.hpp"

namespace mpm {

/// What the laws of clay in undrained loading share: elasticity, and a strength that grows linearly with
/// depth below a level and belongs to the particle. Young's modulus is one value, or `rigidity` times the
/// strength of the particle.
template <class T>
struct Clay {
  using real = T;
  T young, poisson, su, su_gradient, su_datum, rigidity;
  /// lambda and G [Pa] of young and poisson, and of rigidity and poisson what they grow with the strength
  /// [-]; read at once.
  struct alignas(16) Stiffness {
    T lambda, shear_modulus, lambda_over_su, shear_modulus_over_su;
  } stiffness;

  /// The rows of the table of parameters that the laws share.
  template <class Law>
  static constexpr std::array<Parameter<Law>, 6> clay_parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return {{{"young", &Law::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
             {"poisson", &Law::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required},
             {"su", &Law::su, "Pa", "undrained shear strength at and above su_datum", 0, 1e12, required},
             {"su_gradient", &Law::su_gradient, "Pa/m", "growth of the strength with depth", 0, 1e12, 0},
             {"su_datum", &Law::su_datum, "m", "level below which the strength grows", -1e9, 1e9, 0},
             {"rigidity", &Law::rigidity, "-",
              "Young's modulus over the undrained shear strength, in lieu of young", 1, 1e7, 0, "young"}}};
  }
  /// Called once the parameters are set.
  void prepare() {
    stiffness = {static_cast<T>(lame_of<double>(young, poisson)),
                 static_cast<T>(shear_modulus_of<double>(young, poisson)),
                 static_cast<T>(lame_of<double>(rigidity, poisson)),
                 static_cast<T>(shear_modulus_of<double>(rigidity, poisson))};
  }

  enum : int { plastic_strain, strength };
  using State = LawState<T, 2>;
  static constexpr std::array<StateVariable, 2> state() {
    return {{{"plastic_strain", "-"},  // accumulated engineering plastic shear strain
             {.name = "strength", .unit = "Pa", .changes = false, .output = false, .parameter = "su"}}};
  }
  ParameterFault check() const {
    if (young > 0 || su > 0) return {};
    return {"su", "a strength in Pa greater than 0 where -NAME_rigidity is given"};
  }
  std::array<double, 2> initial_state(const ParticleStart& at) const {
    return {0, at.own.value_or(su + (at.height < su_datum ? su_gradient * (su_datum - at.height) : 0.0))};
  }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const State& state) const {
    return stiffness.lambda + 2 * stiffness.shear_modulus +
           (stiffness.lambda_over_su + 2 * stiffness.shear_modulus_over_su) * state[strength];
  }
  /// Undrained shear strength [Pa].
  KOKKOS_FUNCTION T shear_strength(const State& state) const { return state[strength]; }
  /// Energy that the soil can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    return elastic_energy(stress, stiffness.lambda + stiffness.lambda_over_su * state[strength],
                          stiffness.shear_modulus + stiffness.shear_modulus_over_su * state[strength]);
  }
};

}  // namespace mpm
