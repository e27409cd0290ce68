#pragma once
#include <array>
#include <limits>

#include "physics/materials/cam_clay_return.hpp"
#include "physics/materials/deviator.hpp"
#include "physics/materials/material.hpp"

namespace mpm {

/// Modified Cam-Clay (Borja & Lee 1990, Borja 1991): f = q^2/M^2 + P (P - Pc), associated, with the mean
/// effective pressure P (compression positive), dP = v/kappa P de_v and dPc/Pc = v/(lambda - kappa) de_v^p.
/// Constant Poisson's ratio, or a constant shear modulus. The surface is a circle in the deviatoric plane.
/// Steps are done in sub-increments; written for one particle.
template <class T>
struct CamClay {
  using real = T;
  static constexpr const char* k_name = "cam_clay";
  static constexpr bool k_scalar_update = true, k_called_update = true, k_stiffness_changes = true;
  /// What a failed particle is said to have; see failed().
  static constexpr const char* k_failure =
      "has a specific volume of 1.02 or less, or strained by more than 0.0064 in one step: cam_clay does not "
      "hold there";
  static constexpr double k_least_volume = 1.02;       // -, specific volume
  static constexpr double k_largest_increment = 2e-4;  // -, of strain, of a sub-increment
  static constexpr int k_most_increments = 32;
  static constexpr double k_standard_least = 1e3, k_standard_share = 1e-3;  // Pa, - of pressure_min

  T critical_state_ratio, lambda, kappa, poisson, shear_modulus, specific_volume_start, ocr,
      preconsolidation_start, pressure_min;
  T shear_ratio;                         // -, G over K where Poisson's ratio is constant, else 0
  T least;                               // Pa, pressure_min or its default
  T inv_kappa, inv_plastic, inv_slope2;  // -, 1/kappa, 1/(lambda - kappa), 1/M^2

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::to_array<Parameter<CamClay>>(
        {{"critical_state_ratio", &CamClay::critical_state_ratio, "-", "M, q/P in the critical state", 1e-3,
          3, required},
         {"lambda", &CamClay::lambda, "-", "slope of the normal compression line in v and ln P", 1e-6, 10,
          required},
         {"kappa", &CamClay::kappa, "-", "slope of unloading and reloading in v and ln P", 1e-7, 10,
          required},
         {"poisson", &CamClay::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required},
         {"shear_modulus", &CamClay::shear_modulus, "Pa", "constant shear modulus, in lieu of poisson", 1e-3,
          1e15, 0, "poisson"},
         {"specific_volume", &CamClay::specific_volume_start, "-", "specific volume 1 + e at the start", 1,
          100, required},
         {"ocr", &CamClay::ocr, "-",
          "overconsolidation ratio: Pc over the size of the yield surface through the initial stress", 1, 1e6,
          required},
         {"preconsolidation", &CamClay::preconsolidation_start, "Pa",
          "preconsolidation pressure Pc at the start, in lieu of ocr", 1e-3, 1e12, 0, "ocr"},
         {"pressure_min",
          &CamClay::pressure_min,
          "Pa",
          "pressure below which the stiffness is constant",
          1e-6,
          1e9,
          0,
          nullptr,
          {{{"auto", 0}}}}});
  }
  /// Called once the parameters are set.
  void prepare() {
    const double nu = poisson;
    shear_ratio = shear_modulus > 0 ? T(0) : static_cast<T>(3 * (1 - 2 * nu) / (2 * (1 + nu)));
    least = pressure_min > 0 ? pressure_min : static_cast<T>(k_standard_least);
    inv_kappa = 1 / kappa, inv_plastic = 1 / (lambda - kappa);
    inv_slope2 = 1 / (critical_state_ratio * critical_state_ratio);
  }
  /// The default of pressure_min follows from the initial stress.
  void prepare_for(const RunFigures& run) {
    if (pressure_min > 0 || !(run.largest_pressure > 0)) return;
    pressure_min = static_cast<T>(Kokkos::fmin(k_standard_least, k_standard_share * run.largest_pressure));
    prepare();
  }

  enum : int { preconsolidation, specific_volume, preconsolidation_rest, specific_volume_rest };
  using State = LawState<T, 4>;
  static constexpr std::array<StateVariable, 4> state() {
    return {{{"preconsolidation", "Pa"},
             {"specific_volume", "-"},
             rest_variable<T>("preconsolidation_rest", "Pa"),
             rest_variable<T>("specific_volume_rest", "-")}};
  }
  ParameterFault check() const {
    if (!(kappa < lambda)) return {"kappa", "a slope less than -NAME_lambda"};
    if (!(specific_volume_start > k_least_volume))
      return {"specific_volume", "a specific volume greater than 1.02, below which a run ends"};
    return {};
  }
  /// Size of the yield surface through a stress [Pa]: P + q^2/(M^2 P).
  double surface_through(const std::array<double, 6>& stress) const {
    const double p = -(stress[0] + stress[1] + stress[2]) / 3,
                 ratio2 = critical_state_ratio * critical_state_ratio;
    const SymTensor<double, 3> s{stress[0], stress[1], stress[2], stress[3], stress[4], stress[5]};
    return p > 0 ? p + 3 * second_invariant(s, -p) / (ratio2 * p) : 0;
  }
  ParameterFault start_fault(const ParticleStart& at) const {
    constexpr double k_round_off = 1e-6;
    const double size = surface_through(at.stress);
    if (!(size > 0))
      return {
          "stress",
          "a stress whose mean is compressive at every particle of cam_clay, whose stiffness is that of its "
          "pressure: give the stress of level ground (K0), or start from the particles of a run that loaded "
          "the "
          "soil by gravity with another model"};
    if (preconsolidation_start > 0 && preconsolidation_start < size * (1 - k_round_off))
      return {"preconsolidation", "a pressure in Pa of at least " + std::to_string(size) +
                                      ", the size of the yield surface through the initial stress"};
    return {};
  }
  std::array<double, 4> initial_state(const ParticleStart& at) const {
    const double by_ratio = Kokkos::fmax(double(least), ocr * surface_through(at.stress));
    return {preconsolidation_start > 0 ? preconsolidation_start : by_ratio, specific_volume_start, 0, 0};
  }

  /// K + 4/3 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>& stress, const State& state) const {
    const T bulk_modulus = state[specific_volume] / kappa * Kokkos::fmax(-mean_of(stress), least);
    return bulk_modulus + shear_modulus_of_step(bulk_modulus) * T(4.0 / 3);
  }
  /// 0: the strength follows the pressure.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }
  /// Energy that the soil can give back [J/m3]: the integral of P over the elastic volume strain, and of the
  /// shear stress at the present modulus.
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    const T mean = mean_of(stress), p = Kokkos::fmax(T(0), -mean);
    const T of_strain = kappa / Kokkos::fmax(state[specific_volume], T(1));  // -, 1/a
    const T of_volume = of_strain * (p >= least ? p - least / 2 : p * p / (2 * least));
    const T shear = shear_modulus_of_step(Kokkos::fmax(p, least) / of_strain);
    return of_volume + second_invariant(stress, mean) / (2 * shear);
  }
  /// Whether a particle is where the law does not hold; the run then ends.
  KOKKOS_FUNCTION bool failed(const State& state) const {
    return !(state[specific_volume] > T(k_least_volume));
  }

  template <int Dim>
  KOKKOS_FUNCTION void update(SymTensor<T, Dim>& s, State& state, const Increment<T, T, Dim>& by) const {
    s = rotated(s, by.spin);
    T square = 0;
    for (int k = 0; k < sym_size<Dim>; ++k) square += (k < 3 ? 1 : 2) * by.strain[k] * by.strain[k];
    const T wanted = Kokkos::ceil(Kokkos::sqrt(square) * T(1 / k_largest_increment));
    const bool too_many = !(wanted <= k_most_increments);
    const int parts = too_many ? k_most_increments : Kokkos::max(1, static_cast<int>(wanted));
    const T share = parts > 1 ? 1 / static_cast<T>(parts) : T(1);
    SymTensor<T, Dim> part;
    for (int k = 0; k < sym_size<Dim>; ++k) part[k] = by.strain[k] * share;
    MPM_ROLLED
    for (int n = 0; n < parts; ++n) strain_by(s, state, part);
    if (too_many) state[specific_volume] = state[specific_volume_rest] = 0;  // failed() tells it
  }

 private:
  KOKKOS_INLINE_FUNCTION T shear_modulus_of_step(T bulk_modulus) const {
    return shear_ratio > 0 ? shear_ratio * bulk_modulus : shear_modulus;
  }

  /// One sub-increment of strain `e`.
  template <int Dim>
  KOKKOS_INLINE_FUNCTION void strain_by(SymTensor<T, Dim>& s, State& state,
                                        const SymTensor<T, Dim>& e) const {
    const T mean = mean_of(s), p = Kokkos::fmax(T(0), -mean), pc = state[preconsolidation];
    const T dilatation = e[0] + e[1] + e[2], v = state[specific_volume],
            v_middle = v * (1 + growth_of(dilatation / 2));
    add_with_rest(state[specific_volume], state[specific_volume_rest], v * growth_of(dilatation));
    const T a = v_middle * inv_kappa, b = v_middle * inv_plastic;
    const ElasticPressure<T> elastic{least};
    const T rise = elastic.change(p, -a * dilatation), trial = p + rise;
    if (!(trial > 0)) {  // no pressure is left, and no stress
      for (int k = 0; k < sym_size<Dim>; ++k) s[k] = 0;
      return;
    }
    const T shear = shear_modulus_of_step(a * elastic.slope(p + rise / 2));
    add_shear(s, e, dilatation, shear);
    const T misfit = mean + p;  // 0, unless the stress was tensile
    for (int k = 0; k < 3; ++k) s[k] -= rise + misfit;
    const T inv_pc = 1 / pc, over = trial * inv_pc;
    const T q = Kokkos::sqrt(3 * second_invariant(s, mean - rise - misfit)) * inv_pc;
    if (q * q * inv_slope2 + over * (over - 1) <= 0) return;
    const CamClayReturn<T> to_surface{{least * inv_pc}, p * inv_pc, -dilatation, a, b, q, over,
                                      shear * inv_pc,   inv_slope2};
    const auto [l, x] = to_surface.solve();  // multiplier times Pc, plastic volume strain
    const T less = rise - elastic.change(p, a * (-dilatation - x)),
            softer = 6 * shear * inv_pc * l * inv_slope2;
    const bool free = !(trial - less > 0);
    const T from = mean_of(s), share = 1 / (1 + softer);
    for (int k = 0; k < sym_size<Dim>; ++k)
      s[k] = free ? T(0) : s[k] + (k < 3 ? less - softer * share * (s[k] - from) : -softer * share * s[k]);
    add_with_rest(state[preconsolidation], state[preconsolidation_rest],
                  pc * growth_of(Kokkos::fmin(T(4), Kokkos::fmax(T(-4), b * x))));
    if (!(state[preconsolidation] > least)) state[preconsolidation] = least, state[preconsolidation_rest] = 0;
  }
};

}  // namespace mpm
