#pragma once
#include "physics/materials/clay.hpp"
#include "physics/materials/friction.hpp"
#include "physics/materials/parting.hpp"

namespace mpm {

/// Elastic, perfectly plastic clay in undrained loading: yield at s1 - s3 = 2 su, so that the strength is su
/// in every mode of shear; von Mises' circle of the same su carries up to 1.155 times that off plane strain.
/// An optional cut-off of the largest principal stress, at which the clay parts (parting.hpp). Jaumann rate
/// of the Cauchy stress.
template <class T>
struct Tresca : Clay<T> {
  static constexpr const char* k_name = "tresca";
  using Clay<T>::plastic_strain;
  using Clay<T>::strength;
  T tension;  // Pa, or k_no_tension
  PyramidShape<T> shape;

  static constexpr auto parameters() {
    const std::array<Parameter<Tresca>, 1> own = {{{"tension",
                                                    &Tresca::tension,
                                                    "Pa",
                                                    "largest principal stress, tension positive",
                                                    0,
                                                    1e12,
                                                    k_no_tension,
                                                    nullptr,
                                                    {{{"none", k_no_tension}}}}}};
    return joined(Clay<T>::template clay_parameters<Tresca>(), own,
                  YoungsModulus<T>::template growth_rows<Tresca>(),
                  Clay<T>::template strength_rows<Tresca>());
  }
  /// Called once the parameters are set.
  void prepare() {
    Clay<T>::prepare();
    shape = PyramidShape<T>::of(0, 0, this->poisson);
  }
  ParameterFault check() const {
    if (this->su == 0 && this->su_gradient == 0 && this->su_ratio == 0)
      return {"su", "a strength in Pa greater than 0 where -NAME_su_gradient is 0"};
    return Clay<T>::check();
  }

  enum : int { parted = strength + 1, young_of_particle };
  using State = LawState<T, 4>;
  static constexpr std::array<StateVariable, 4> state() {
    const auto [plastic, su0, own_young] = Clay<T>::state();
    return {{plastic, su0, parted_variable(), own_young}};
  }
  /// Clay without a limit of tension does not part. Only the last variables may be missing.
  KOKKOS_FUNCTION bool carries(int k) const {
    return k < parted || this->varies() || (k == parted && tension >= 0);
  }
  std::array<double, 4> initial_state(const ParticleStart& at) const {
    const auto [plastic, su0, own_young] = Clay<T>::initial_state(at);
    return {plastic, su0, 0, own_young};
  }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>& stress, const State& state) const {
    return Clay<T>::wave_modulus(stress, of_clay(state));
  }
  /// Undrained shear strength [Pa].
  KOKKOS_FUNCTION T shear_strength(const State& state) const {
    return Clay<T>::shear_strength(of_clay(state));
  }
  /// Energy that the soil can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    return Clay<T>::stored_energy(stress, of_clay(state));
  }

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 4>& state,
                              const Increment<R, T, Dim>& by) const {
    const auto& e = this->stiffness;
    const R basis = this->basis_of(state[strength], state[young_of_particle]);     // Pa
    const R shear_modulus = e.shear_modulus + e.shear_modulus_over_basis * basis;  // Pa
    const R su_p = this->strength_share * state[strength];                         // Pa
    const SymTensor<R, Dim> before = rotated(s, by.spin);
    s = before;
    add_elastic(s, by.strain, R(e.lambda + e.lambda_over_basis * basis), shear_modulus);
    if (any_of(state[parted] > 0)) {
      const ClosedGap<R, Dim> closed = closed_gap(shape, Truth<R>{}, shear_modulus, before, s, state[parted]);
      s = closed.stress, state[parted] = closed.parted;
    }
    const PyramidSize<R> size{
        .sc = 2 * su_p, .cut_off = tension, .low = tension - 2 * su_p, .cuts = tension >= 0, .apex = {}};
    const PlasticFlow<R> flow = return_stress(shape, size, shear_modulus, Truth<R>{}, s);
    state[plastic_strain] += flow.strain;
    state[parted] += flow.opening;
  }

 private:
  KOKKOS_INLINE_FUNCTION static typename Clay<T>::State of_clay(const State& state) {
    return {{state[plastic_strain], state[strength], state[young_of_particle]}};
  }
};

}  // namespace mpm
