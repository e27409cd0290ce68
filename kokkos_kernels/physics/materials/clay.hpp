#pragma once
#include <array>

#include "physics/materials/elasticity.hpp"

namespace mpm {

/// Common part of the laws of clay in undrained loading: elasticity, and a strength that grows linearly with
/// depth below a level and belongs to the particle. Young's modulus is one value, or the particle's own, or
/// `rigidity` times the strength of the particle.
template <class T>
struct Clay : YoungsModulus<T> {
  T su, su_gradient, su_datum, rigidity, su_ratio, strength_factor;
  T strength_share;  // -, of the strength of a particle that is left: 1 / strength_factor
  /// lambda and G [Pa] of one Young's modulus, and what they grow with basis_of() a particle [-]; read at
  /// once.
  struct alignas(16) Stiffness {
    T lambda, shear_modulus, lambda_over_basis, shear_modulus_over_basis;
  } stiffness;

  /// The rows of the table of parameters that the laws share.
  template <class Law>
  static constexpr std::array<Parameter<Law>, 6> clay_parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    const std::array<Parameter<Law>, 4> own = {
        {{"su", &Law::su, "Pa", "undrained shear strength at and above su_datum", 0, 1e12, required},
         {"su_gradient", &Law::su_gradient, "Pa/m", "growth of the strength with depth", 0, 1e12, 0},
         {"su_datum", &Law::su_datum, "m", "level below which the strength grows", -1e9, 1e9, 0},
         {"rigidity", &Law::rigidity, "-",
          "Young's modulus over the undrained shear strength, in lieu of young", 1, 1e7, 0, "young"}}};
    return joined(YoungsModulus<T>::template young_rows<Law>(), own);
  }
  /// The rows at the end of the tables of the laws.
  template <class Law>
  static constexpr std::array<Parameter<Law>, 2> strength_rows() {
    const std::array<Parameter<Law>, 1> ratio = {
        {{"su_ratio", &Law::su_ratio, "-",
          "strength over the vertical effective stress that a particle begins with; where su and su_gradient "
          "give more, that is the strength",
          0, 10, 0}}};
    return joined(ratio, strength_factor_row<Law>());
  }
  /// Called once the parameters are set.
  void prepare() {
    strength_share = strength_factor > 0 ? 1 / strength_factor : T(1);
    const double nu = this->poisson, one = this->varies() ? 0 : this->young,
                 grows = this->varies() ? this->reference_young() : rigidity;
    stiffness = {static_cast<T>(lame_of(one, nu)), static_cast<T>(shear_modulus_of(one, nu)),
                 static_cast<T>(lame_of(grows, nu)), static_cast<T>(shear_modulus_of(grows, nu))};
  }

  enum : int { plastic_strain, strength, young_of_particle };
  using State = LawState<T, 3>;
  static constexpr std::array<StateVariable, 3> state() {
    return {{{"plastic_strain", "-"},  // accumulated engineering plastic shear strain
             {.name = "strength", .unit = "Pa", .changes = false, .output = false, .parameter = "su"},
             YoungsModulus<T>::young_variable()}};
  }
  KOKKOS_FUNCTION bool carries(int k) const { return k != young_of_particle || this->varies(); }
  ParameterFault check() const {
    if (rigidity > 0 && this->young_gradient > 0)
      return {"young_gradient", "0 where -NAME_rigidity is given"};
    if (rigidity > 0 && su_ratio > 0)
      return {"su_ratio", "0 where -NAME_rigidity is given; give -NAME_young"};
    if (this->young == 0 && !(su > 0))
      return {"su", "a strength in Pa greater than 0 where -NAME_rigidity is given"};
    return this->young_fault();
  }
  std::array<double, 3> initial_state(const ParticleStart& at) const {
    const double depth = at.height < su_datum ? su_datum - at.height : 0.0,
                 profile = su + su_gradient * depth, by_stress = su_ratio * at.vertical();
    return {0, at.own[0].value_or(by_stress > profile ? by_stress : profile),
            this->young_at(at.height, at.own[1])};
  }

  /// Whether the law has a strength for a particle.
  ParameterFault start_fault(const ParticleStart& at) const {
    if (!(su_ratio > 0) || initial_state(at)[strength] > 0) return {};
    return {"stress",
            "a vertical stress in compression where -NAME_su_ratio gives the strength and -NAME_su is 0"};
  }

  /// Factor of a particle's stiffness where Young's modulus is not one value: the particle's own modulus, or
  /// its strength.
  template <class R>
  KOKKOS_INLINE_FUNCTION R basis_of(const R& strength_of_particle, const R& own_young) const {
    return this->varies() ? own_young : strength_of_particle;
  }
  KOKKOS_INLINE_FUNCTION T basis_of(const State& state) const {
    return basis_of(state[strength], state[young_of_particle]);
  }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const State& state) const {
    return stiffness.lambda + 2 * stiffness.shear_modulus +
           (stiffness.lambda_over_basis + 2 * stiffness.shear_modulus_over_basis) * basis_of(state);
  }
  /// Undrained shear strength [Pa].
  KOKKOS_FUNCTION T shear_strength(const State& state) const { return strength_share * state[strength]; }
  /// Energy that the soil can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    const T basis = basis_of(state);
    return elastic_energy(stress, stiffness.lambda + stiffness.lambda_over_basis * basis,
                          stiffness.shear_modulus + stiffness.shear_modulus_over_basis * basis);
  }
};

}  // namespace mpm
