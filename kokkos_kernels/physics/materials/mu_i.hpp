#pragma once
#include <array>
#include <cmath>
#include <limits>

#include "physics/materials/deviator.hpp"
#include "physics/materials/parting.hpp"

namespace mpm {

/// Dry grains that flow by the mu(I) law (Jop, Forterre & Pouliquen 2006), with the closed return of
/// Dunatunga & Kamrin (2015): sqrt(J2) <= mu(I) P, mu = mu_s + (mu_2 - mu_s) I / (I0 + I), I = gd dg
/// sqrt(rs / P) with the rate of shear gd. Elastic below mu_s P, so that a heap rests. No cohesion and no
/// dilatancy. Grains that part carry no stress until they have come together again. Jaumann rate of the
/// Cauchy stress.
template <class T>
struct MuI {
  using real = T;
  static constexpr const char* k_name = "mu_i";
  static constexpr bool k_scalar_update = true;
  T young, poisson, mu_static, mu_dynamic, inertial_number, grain_diameter, grain_density;
  T lambda, shear_modulus, bulk_modulus;  // Pa, of young and poisson
  T flow;                                 // sqrt(Pa)/s, G I0 / (dg sqrt(rs))

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::to_array<Parameter<MuI>>(
        {{"young", &MuI::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
         {"poisson", &MuI::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required},
         {"mu_static", &MuI::mu_static, "-", "friction sqrt(J2)/P of grains at rest", 1e-6, 10, required},
         {"mu_dynamic", &MuI::mu_dynamic, "-", "friction of the fastest flow", 1e-6, 10, required},
         {"inertial_number", &MuI::inertial_number, "-", "inertial number half way between the two", 1e-9,
          1e6, required},
         {"grain_diameter", &MuI::grain_diameter, "m", "diameter of a grain", 1e-9, 1e3, required},
         {"grain_density", &MuI::grain_density, "kg/m3", "density of a grain", 1e-3, 1e6, required}});
  }
  /// Called once the parameters are set.
  void prepare() {
    const double shear = shear_modulus_of<double>(young, poisson), lame = lame_of<double>(young, poisson);
    lambda = static_cast<T>(lame), shear_modulus = static_cast<T>(shear);
    bulk_modulus = static_cast<T>(lame + 2 * shear / 3);
    flow = static_cast<T>(shear * inertial_number / (grain_diameter * std::sqrt(double(grain_density))));
  }

  enum : int { plastic_strain, parted };
  using State = LawState<T, 2>;
  static constexpr std::array<StateVariable, 2> state() {
    return {{{"plastic_strain", "-"},  // accumulated engineering shear strain that is not elastic
             parted_variable()}};
  }
  ParameterFault check() const {
    if (mu_static < mu_dynamic) return {};
    return {"mu_dynamic", "a friction greater than -NAME_mu_static"};
  }
  std::array<double, 2> initial_state(const ParticleStart&) const { return {}; }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const State&) const {
    return lambda + 2 * shear_modulus;
  }
  /// Undrained shear strength [Pa]; none here: it follows the pressure.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }
  /// Volume strain of a gap in all directions, across which the soil takes no pressure.
  KOKKOS_FUNCTION T free_gap(const State& state) const { return state[parted]; }
  /// Energy that the grains can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State&) const {
    return elastic_energy(stress, lambda, shear_modulus);
  }

  /// sqrt(J2) [Pa] at the end of a step dt [s] whose elastic trial is beyond mu_s P, P > 0 (Dunatunga &
  /// Kamrin 2015): the lesser root of a quadratic. Its discriminant is a sum of terms that are not negative.
  KOKKOS_FUNCTION T flowing_stress(T trial, T pressure, T dt) const {
    const T low = mu_static * pressure, high = mu_dynamic * pressure;
    const T rate = flow * dt * Kokkos::sqrt(pressure);  // Pa
    const T apart = high - trial - rate;
    const T root = Kokkos::sqrt(apart * apart + 4 * rate * (high - low));
    return 2 * (high * trial + low * rate) / (high + trial + rate + root);
  }

  template <int Dim>
  KOKKOS_FUNCTION void update(SymTensor<T, Dim>& s, State& state, const Increment<T, T, Dim>& by) const {
    s = rotated(s, by.spin);
    const T mean = mean_of(s), dilatation = by.strain[0] + by.strain[1] + by.strain[2];
    const T pressure = -mean - bulk_modulus * (state[parted] + dilatation);
    add_shear(s, by.strain, dilatation, shear_modulus);
    const T trial = shear_stress_of(s, mean);
    T stress = trial;
    if (pressure <= 0)
      stress = 0;
    else if (trial > mu_static * pressure)
      stress = flowing_stress(trial, pressure, by.dt);
    const T share = stress < trial ? stress / trial : T(1);
    s = with_deviator(s, mean, share, Kokkos::fmin(-pressure, T(0)));
    state[parted] = Kokkos::fmax(-pressure, T(0)) / bulk_modulus;
    if (stress < trial) state[plastic_strain] += (trial - stress) / shear_modulus;
  }
};

}  // namespace mpm
