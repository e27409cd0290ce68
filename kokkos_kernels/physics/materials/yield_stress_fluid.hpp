#pragma once
#include <array>
#include <cmath>
#include <limits>

#include "physics/materials/deviator.hpp"
#include "physics/materials/parting.hpp"

namespace mpm {

/// The root y of y + a y^p = 1, p >= 1, given log a: Newton's method for w = log y in log(e^w + a e^(p w)) =
/// 0, which is convex and between two straight lines, so that few iterations do from where the lines meet
/// (test_flowing_laws.cpp). Returns y and a y^p, each to round-off, however small.
template <class T>
struct YieldFlowRoot {
  T first, second;

  KOKKOS_INLINE_FUNCTION static YieldFlowRoot of(T log_a, T p) {
    constexpr int k_iterations = sizeof(T) == 4 ? 5 : 6;
    T w = Kokkos::fmin(T(0), -log_a / p);
    for (int n = 0; n < k_iterations; ++n) {
      const T a = Kokkos::exp(w), b = Kokkos::exp(log_a + p * w);
      w -= Kokkos::log(a + b) * (a + b) / (a + p * b);
    }
    return {Kokkos::exp(w), Kokkos::exp(log_a + p * w)};
  }
};

/// Fluid with a yield stress (Bingham 1922; Herschel & Bulkley 1926): elastic up to sqrt(J2) = tau_y, so that
/// rest is rest; beyond, sqrt(J2) = tau_y + k g^n with the rate g of the shear that is not elastic. Backward
/// Euler in the particle, so that viscosity does not bound the time step. A fluid that takes no tension and
/// has parted has no pressure until it has come together again. Jaumann rate of the Cauchy stress.
template <class T>
struct YieldStressFluid {
  using real = T;
  static constexpr const char* k_name = "yield_stress_fluid";
  static constexpr bool k_scalar_update = true;
  T bulk_modulus, shear_modulus, yield_stress, consistency, exponent, tension;
  T lambda;           // Pa, of the two moduli
  T log_consistency;  // of its number in Pa s^n

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    using Law = YieldStressFluid;
    return std::to_array<Parameter<Law>>(
        {{"bulk_modulus", &Law::bulk_modulus, "Pa", "bulk modulus", 1e-3, 1e15, required},
         {"shear_modulus", &Law::shear_modulus, "Pa", "shear modulus below the yield stress", 1e-3, 1e15,
          required},
         {"yield_stress", &Law::yield_stress, "Pa", "sqrt(J2) at yield, the shear stress of simple shear", 0,
          1e12, required},
         {"consistency", &Law::consistency, "Pa s^n", "shear stress beyond yield at the rate 1/s", 0, 1e12,
          required},
         {"exponent", &Law::exponent, "-", "exponent n of the rate; 1: Bingham", 0.05, 3, 1},
         {.key = "tension",
          .member = &Law::tension,
          .unit = "",
          .meaning = "whether the fluid takes a tensile mean stress",
          .lowest = 0,
          .highest = -1,
          .standard = 0,
          .words = {{{"off", 0}, {"on", 1}}}}});
  }
  /// Called once the parameters are set.
  void prepare() {
    lambda = static_cast<T>(bulk_modulus - 2.0 * shear_modulus / 3);
    log_consistency = static_cast<T>(std::log(double(consistency)));
  }

  enum : int { plastic_strain, parted };
  using State = LawState<T, 2>;
  static constexpr std::array<StateVariable, 2> state() {
    return {{{"plastic_strain", "-"},  // accumulated engineering shear strain that is not elastic
             parted_variable()}};
  }
  KOKKOS_FUNCTION bool carries(int k) const { return k != parted || tension == 0; }
  ParameterFault check() const {
    if (shear_modulus >= 10 * yield_stress) return {};
    return {"shear_modulus", "a modulus in Pa of at least 10 times -NAME_yield_stress"};
  }
  std::array<double, 2> initial_state(const ParticleStart&) const { return {}; }

  /// K + 4 G / 3 [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const State&) const {
    return lambda + 2 * shear_modulus;
  }
  /// sqrt(J2) [Pa] at yield.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return yield_stress; }
  /// Volume strain of a gap in all directions, across which the soil takes no pressure.
  KOKKOS_FUNCTION T free_gap(const State& state) const { return state[parted]; }
  /// Energy that the fluid can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State&) const {
    return elastic_energy(stress, lambda, shear_modulus);
  }

  /// Result of the flow in a step dt [s], from an elastic trial that is `beyond` [Pa] the yield stress.
  struct Flow {
    T stress;  // Pa, k g^n: what stays of `beyond`
    T strain;  // -, g dt
  };
  /// Solves beyond = G g dt + k g^n: in the share y of the part that is linear in the unknown, and a y^p of
  /// the other one. For n < 1 the unknown is the stress, else the rate, so that p >= 1.
  MPM_CALLED_FUNCTION Flow flow(T beyond, T dt) const {
    const T stiffness = shear_modulus * dt;  // Pa s
    if (exponent == 1) {
      const T rate = beyond / (stiffness + consistency);
      return {consistency * rate, rate * dt};
    }
    if (consistency == 0) return {0, beyond / shear_modulus};
    const bool thins = exponent < 1;
    const T p = thins ? 1 / exponent : exponent;
    if (p == 2) {
      const T of_unknown = thins ? consistency : stiffness, of_other = thins ? stiffness : consistency,
              a = (of_other / of_unknown) * (beyond / of_unknown);
      if (a < T(1e30)) {
        const T y = 2 / (1 + Kokkos::sqrt(1 + 4 * a)), rest = a * y * y;
        return {beyond * (thins ? y : rest), beyond * (thins ? rest : y) / shear_modulus};
      }
    }
    // a = G dt beyond^(p - 1) / k^p, or k beyond^(p - 1) / (G dt)^p
    const T log_stiffness = Kokkos::log(stiffness), log_beyond = Kokkos::log(beyond);
    const T log_a = (p - 1) * log_beyond +
                    (thins ? log_stiffness - p * log_consistency : log_consistency - p * log_stiffness);
    const auto share = YieldFlowRoot<T>::of(log_a, p);
    return {beyond * (thins ? share.first : share.second),
            beyond * (thins ? share.second : share.first) / shear_modulus};
  }

  template <int Dim>
  KOKKOS_FUNCTION void update(SymTensor<T, Dim>& s, State& state, const Increment<T, T, Dim>& by) const {
    s = rotated(s, by.spin);
    const T before = mean_of(s), dilatation = by.strain[0] + by.strain[1] + by.strain[2];
    T mean = before + bulk_modulus * (state[parted] + dilatation);
    if (tension == 0) {
      state[parted] = Kokkos::fmax(mean, T(0)) / bulk_modulus;
      mean = Kokkos::fmin(mean, T(0));
    }
    add_shear(s, by.strain, dilatation, shear_modulus);
    const T trial = shear_stress_of(s, before);
    const T strength = state[parted] > 0 ? yield_stress * share_across(state[parted]) : yield_stress;
    T share = 1;
    if (trial > strength) {
      const Flow flown = flow(trial - strength, by.dt);
      share = (strength + flown.stress) / trial;
      state[plastic_strain] += flown.strain;
    }
    s = with_deviator(s, before, share, mean);
  }
};

}  // namespace mpm
