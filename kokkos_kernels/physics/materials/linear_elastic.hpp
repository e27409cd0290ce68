#pragma once
#include <array>

#include "physics/materials/elasticity.hpp"

namespace mpm {

/// Isotropic linear elasticity with the Jaumann rate of the Cauchy stress (hypoelastic).
template <class T>
struct LinearElastic : Elasticity<T, 0> {
  static constexpr const char* k_name = "linear_elastic";

  static constexpr auto parameters() {
    return joined(YoungsModulus<T>::template young_rows<LinearElastic>(),
                  YoungsModulus<T>::template growth_rows<LinearElastic>());
  }
  /// Called once the parameters are set.
  void prepare() { this->prepare_elasticity(); }

  using State = LawState<T, 1>;
  static constexpr std::array<StateVariable, 1> state() { return {{YoungsModulus<T>::young_variable()}}; }
  ParameterFault check() const { return this->young_fault(); }
  std::array<double, 1> initial_state(const ParticleStart& at) const {
    return {{this->young_at(at.height, at.own[0])}};  // nvcc drops a single pair of braces
  }
  /// Undrained shear strength [Pa]; none here.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }

  template <class R, int Dim>
  KOKKOS_FORCEINLINE_FUNCTION void update(SymTensor<R, Dim>& stress, LawState<R, 1>& state,
                                          const Increment<R, T, Dim>& by) const {
    stress = rotated(stress, by.spin);
    this->add_elastic_to(stress, by.strain, state);
  }
};

}  // namespace mpm
