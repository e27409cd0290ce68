#pragma once
#include <array>
#include <limits>

#include "physics/materials/material.hpp"

namespace mpm {

/// Elastic, perfectly plastic clay in undrained loading: yield at sqrt(J2) = su, radial return, so that the
/// plane-strain shear strength is su. The strength grows linearly with depth below a level and then belongs
/// to the particle. Young's modulus is one value, or `rigidity` times the strength of the particle. Jaumann
/// rate of the Cauchy stress.
template <class T>
struct VonMises {
  using real = T;
  static constexpr const char* k_name = "von_mises";
  T young, poisson, su, su_gradient, su_datum, rigidity;
  /// lambda and G [Pa] of young and poisson, and of rigidity and poisson what they grow with the strength
  /// [-]; read at once.
  struct alignas(16) Stiffness {
    T lambda, shear_modulus, lambda_over_su, shear_modulus_over_su;
  } stiffness;

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::to_array<Parameter<VonMises>>(
        {{"young", &VonMises::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
         {"poisson", &VonMises::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required},
         {"su", &VonMises::su, "Pa", "undrained shear strength at and above su_datum", 0, 1e12, required},
         {"su_gradient", &VonMises::su_gradient, "Pa/m", "growth of the strength with depth", 0, 1e12, 0},
         {"su_datum", &VonMises::su_datum, "m", "level below which the strength grows", -1e9, 1e9, 0},
         {"rigidity", &VonMises::rigidity, "-",
          "Young's modulus over the undrained shear strength, in lieu of young", 1, 1e7, 0, "young"}});
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
             {.name = "strength", .unit = "Pa", .changes = false, .output = false}}};
  }
  ParameterFault check() const {
    if (young > 0 || su > 0) return {};
    return {"su", "a strength in Pa greater than 0 where -NAME_rigidity is given"};
  }
  std::array<double, 2> initial_state(const ParticleStart& at) const {
    return {0, su + (at.height < su_datum ? su_gradient * (su_datum - at.height) : 0.0)};
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

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 2>& state,
                              const Increment<R, T, Dim>& by) const {
    const Stiffness e = stiffness;
    const R su_p = state[strength], shear_modulus = e.shear_modulus + e.shear_modulus_over_su * su_p;  // Pa
    s = rotated(s, by.spin);
    add_elastic(s, by.strain, R(e.lambda + e.lambda_over_su * su_p), shear_modulus);

    const R mean = mean_of(s);
    R j2 = 0;
    for (int k = 0; k < sym_size<Dim>; ++k) {
      const R deviator = k < 3 ? s[k] - mean : s[k];
      j2 += k < 3 ? deviator * deviator / 2 : deviator * deviator;
    }
    const auto yields = j2 > su_p * su_p;
    if (!any_of(yields)) return;
    const R size = Kokkos::sqrt(j2), share = su_p / size;
    for (int k = 0; k < sym_size<Dim>; ++k)
      s[k] = select(yields, k < 3 ? mean + share * (s[k] - mean) : share * s[k], s[k]);
    state[plastic_strain] += select(yields, (size - su_p) / shear_modulus, R(0));
  }
};

}  // namespace mpm
