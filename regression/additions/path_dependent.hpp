#pragma once
#include <array>
#include <limits>

#include "physics/materials/material.hpp"

namespace mpm {

/// A law of the tests, which check.py adds to a copy of the program: elasticity whose stiffness changes once
/// the path of the shear strain passes a threshold, E (1 + change (path - threshold)), but not below a tenth;
/// where it falls, the stress falls with it, so that no energy comes from nothing. The path counts from a
/// time on. The law is written for one particle, with branches. Its state: where along x a particle was
/// created, and the path.
template <class T>
struct PathDependent {
  using real = T;
  static constexpr const char* k_name = "path_dependent";
  static constexpr bool k_scalar_update = true, k_stiffness_changes = true;
  T young, poisson, change, threshold, since;

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::to_array<Parameter<PathDependent>>(
        {{"young", &PathDependent::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
         {"poisson", &PathDependent::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required},
         {"change", &PathDependent::change, "-", "change of stiffness with the path", -1e6, 1e6, 0},
         {"threshold", &PathDependent::threshold, "-", "path without a change", 0, 1e6, 0},
         {"since", &PathDependent::since, "s", "time from which on the path counts", 0, 1e6, 0}});
  }
  void prepare() {}

  enum : int { created_at, path };
  using State = LawState<T, 2>;
  static constexpr std::array<StateVariable, 2> state() {
    return {{{.name = "created_at", .unit = "m", .changes = false}, {"shear_path", "-"}}};
  }
  ParameterFault check() const {
    if (change == 0 || threshold > 0) return {};
    return {"threshold", "a path greater than 0 where -NAME_change is given"};
  }
  std::array<double, 2> initial_state(const ParticleStart& at) const { return {at.position[0], 0}; }

  template <class R>
  KOKKOS_FUNCTION R young_of(const LawState<R, 2>& state) const {
    R young_p = young;
    if (state[path] > threshold) young_p *= Kokkos::fmax(R(0.1), 1 + change * (state[path] - threshold));
    return young_p;
  }
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const State& state) const {
    const T young_p = young_of(state);
    return lame_of(young_p, poisson) + 2 * shear_modulus_of(young_p, poisson);
  }
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    const T young_p = young_of(state);
    return elastic_energy(stress, lame_of(young_p, poisson), shear_modulus_of(young_p, poisson));
  }
  template <int Dim>
  KOKKOS_FUNCTION void update(SymTensor<T, Dim>& stress, State& state, const Increment<T, T, Dim>& by) const {
    const T young_p = young_of(state);
    stress = rotated(stress, by.spin);
    add_elastic(stress, by.strain, lame_of(young_p, poisson), shear_modulus_of(young_p, poisson));
    if (by.time() >= since) state[path] += Kokkos::fabs(by.strain[3]);
    const T after = young_of(state);
    for (int k = 0; k < sym_size<Dim> && after < young_p; ++k) stress[k] *= after / young_p;
  }
};

}  // namespace mpm
