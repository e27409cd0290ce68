#pragma once
#include <array>
#include <limits>

#include "physics/materials/deviator.hpp"

namespace mpm {

/// Newtonian fluid, slightly compressible: s = (mean + K tr de) I + 2 eta de'/dt. It has no stress in shear
/// but the viscous one of the step, so that the spin changes nothing. It takes tension.
template <class T>
struct Newtonian {
  using real = T;
  static constexpr const char* k_name = "newtonian";
  T bulk_modulus, viscosity;

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::to_array<Parameter<Newtonian>>(
        {{"bulk_modulus", &Newtonian::bulk_modulus, "Pa", "bulk modulus", 1e-3, 1e15, required},
         {"viscosity", &Newtonian::viscosity, "Pa s", "dynamic viscosity", 0, 1e12, required}});
  }
  void prepare() {}
  static constexpr std::array<StateVariable, 0> state() { return {}; }
  ParameterFault check() const { return {}; }
  std::array<double, 0> initial_state(const ParticleStart&) const { return {}; }

  /// Largest step [s] that is stable with explicit viscosity on cells of an edge `spacing` [m], for a density
  /// [kg/m3]: rho d^2 / (4 eta) in 2D and rho d^2 / (6 eta) in 3D.
  double largest_time_step(double spacing, double density, int dim) const {
    return density * spacing * spacing / (2 * dim * double(viscosity));
  }
  /// K [Pa], which gives the speed of sound.
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const LawState<T, 0>&) const {
    return bulk_modulus;
  }
  /// Undrained shear strength [Pa]; none here.
  KOKKOS_FUNCTION T shear_strength(const LawState<T, 0>&) const { return 0; }
  /// Energy that the fluid can give back [J/m3]: that of its mean stress.
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const LawState<T, 0>&) const {
    const T mean = mean_of(stress);
    return mean * mean / (2 * bulk_modulus);
  }
  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& stress, LawState<R, 0>&,
                              const Increment<R, T, Dim>& by) const {
    const R dilatation = by.strain[0] + by.strain[1] + by.strain[2];
    const R mean = mean_of(stress) + bulk_modulus * dilatation;
    for (int k = 0; k < sym_size<Dim>; ++k) stress[k] = k < 3 ? mean : R(0);
    add_shear(stress, by.strain, dilatation, viscosity / by.dt);
  }
};

}  // namespace mpm
