#pragma once
#include <array>
#include <limits>

#include "physics/materials/cam_clay_return.hpp"
#include "physics/materials/deviator.hpp"
#include "physics/materials/parting.hpp"

namespace mpm {

/// Modified Cam-Clay (Borja & Lee 1990, Borja 1991): f = q^2/M^2 + P (P - Pc), associated, with the mean
/// effective pressure P (compression positive), dP = v/kappa P de_v and dPc/Pc = v/(lambda - kappa) de_v^p.
/// Constant Poisson's ratio, or a constant shear modulus. The surface is a circle in the deviatoric plane.
/// Clay without pressure has parted (parting.hpp). Steps are done in sub-increments.
template <class T>
struct CamClay {
  using real = T;
  static constexpr const char* k_name = "cam_clay";
  static constexpr bool k_called_update = true, k_stiffness_changes = true;
  /// Message about a failed particle, the end of "a particle ..."; see failed().
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

  enum : int { preconsolidation, specific_volume, preconsolidation_rest, specific_volume_rest, parted };
  using State = LawState<T, 5>;
  static constexpr std::array<StateVariable, 5> state() {
    return {{{"preconsolidation", "Pa"},
             {"specific_volume", "-"},
             rest_variable<T>("preconsolidation_rest", "Pa"),
             rest_variable<T>("specific_volume_rest", "-"),
             parted_variable()}};
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
  std::array<double, 5> initial_state(const ParticleStart& at) const {
    const double by_ratio = Kokkos::fmax(double(least), ocr * surface_through(at.stress));
    return {preconsolidation_start > 0 ? preconsolidation_start : by_ratio, specific_volume_start, 0, 0, 0};
  }

  /// K + 4/3 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>& stress, const State& state) const {
    const T bulk_modulus = state[specific_volume] / kappa * Kokkos::fmax(-mean_of(stress), least);
    return bulk_modulus + shear_modulus_of_step(bulk_modulus) * T(4.0 / 3);
  }
  /// Upper bound of the wave modulus after the soil has been compressed by a volume strain: along the
  /// swelling line to the preconsolidation pressure, and then along the normal compression line.
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus_after(const SymTensor<T, Dim>& stress, const State& state,
                                       T compression) const {
    constexpr T k_most = 20;  // of the logarithm of a pressure, so that what is finite stays finite
    const T v = state[specific_volume], p = Kokkos::fmax(-mean_of(stress), least);
    const T to_surface = Kokkos::fmax(T(0), Kokkos::log(state[preconsolidation] / p));
    const T elastic = v / kappa * compression;
    const T growth = elastic < to_surface ? elastic : to_surface + (elastic - to_surface) * kappa / lambda;
    const T bulk_modulus = v / kappa * p * Kokkos::exp(Kokkos::fmin(k_most, growth));
    return bulk_modulus + shear_modulus_of_step(bulk_modulus) * T(4.0 / 3);
  }
  /// 0: the strength follows the pressure.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }
  /// Volume strain of a gap in all directions, across which the soil takes no pressure.
  KOKKOS_FUNCTION T free_gap(const State& state) const { return state[parted]; }
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

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 5>& state,
                              const Increment<R, T, Dim>& by) const {
    s = rotated(s, by.spin);
    R square = 0;
    for (int k = 0; k < sym_size<Dim>; ++k) square += (k < 3 ? 1 : 2) * by.strain[k] * by.strain[k];
    R parts = 1;
    Truth<R> too_many = !(square <= T(k_largest_increment * k_largest_increment));
    SymTensor<R, Dim> part = by.strain;
    if (any_of(too_many)) {
      const R wanted = Kokkos::ceil(Kokkos::sqrt(square) * T(1 / k_largest_increment));
      too_many = !(wanted <= T(k_most_increments));
      parts = select(too_many, R(k_most_increments), Kokkos::fmax(R(1), wanted));
      const R share = 1 / parts;
      for (int k = 0; k < sym_size<Dim>; ++k) part[k] *= share;
    }
    int n = 0;
    MPM_ROLLED
    do {
      if constexpr (is_lanes<R>)
        strain_by(s, state, part, parts > T(n));
      else
        strain_by(s, state, part, true);
    } while (any_of(parts > T(++n)));
    if (!any_of(too_many)) return;
    state[specific_volume] = select(too_many, R(0), state[specific_volume]);  // failed() finds it
    state[specific_volume_rest] = select(too_many, R(0), state[specific_volume_rest]);
  }

 private:
  template <class R>
  KOKKOS_INLINE_FUNCTION R shear_modulus_of_step(const R& bulk_modulus) const {
    return shear_ratio > 0 ? shear_ratio * bulk_modulus : R(shear_modulus);
  }

  /// One sub-increment of strain `e`, of particles that take part.
  template <class R, int Dim>
  KOKKOS_INLINE_FUNCTION void strain_by(SymTensor<R, Dim>& s, LawState<R, 5>& state,
                                        const SymTensor<R, Dim>& e, const Truth<R>& takes_part) const {
    const R mean = mean_of(s), p = Kokkos::fmax(R(0), -mean), pc = state[preconsolidation];
    const R dilatation = e[0] + e[1] + e[2], v = state[specific_volume], half = growth_of(dilatation / 2),
            v_middle = v * (1 + half);
    add_with_rest_if(takes_part, state[specific_volume], state[specific_volume_rest], v * half * (2 + half));
    const R a = v_middle * inv_kappa, b = v_middle * inv_plastic;
    const ElasticPressure<R> elastic{least};
    const R gap = state[parted], opens = gap + dilatation;
    const R volume = select(gap > 0, Kokkos::fmin(R(0), opens), dilatation);  // without what closes a gap
    const R rise = elastic.change(p, -a * volume), trial = p + rise;
    const Truth<R> presses = trial > 0;  // otherwise no pressure is left, and no stress
    const R shear = shear_modulus_of_step(R(a * elastic.slope(p + rise / 2)));
    SymTensor<R, Dim> next = s;
    add_shear(next, e, dilatation, shear);
    const R misfit = mean + p;  // 0, unless the stress was tensile
    for (int k = 0; k < 3; ++k) next[k] -= rise + misfit;
    const R square = 3 * second_invariant(next, R(mean - rise - misfit));
    const Truth<R> yields = takes_part & presses & !(square * inv_slope2 + trial * (trial - pc) <= 0);
    R left = trial;  // pressure; what is below zero has parted the clay
    if (any_of(yields)) {
      const R inv_pc = 1 / pc;
      const CamClayReturn<R> to_surface{
          {least * inv_pc}, p * inv_pc,     -volume,   a, b, Kokkos::sqrt(square) * inv_pc,
          trial * inv_pc,   shear * inv_pc, inv_slope2};
      const auto [l, x] = to_surface.solve(yields);  // multiplier times Pc, plastic volume strain
      const R less = rise - elastic.change(p, a * (-volume - x)),
              softer = 6 * shear * inv_pc * l * inv_slope2;
      left = select(yields, trial - less, trial);
      const auto free = !(left > 0);
      const R from = mean_of(next), share = softer / (1 + softer);
      for (int k = 0; k < sym_size<Dim>; ++k) {
        const R back = next[k] + (k < 3 ? less - share * (next[k] - from) : -share * next[k]);
        next[k] = select(yields, select(free, R(0), back), next[k]);
      }
      add_with_rest_if(yields, state[preconsolidation], state[preconsolidation_rest],
                       pc * growth_of(Kokkos::fmin(R(4), Kokkos::fmax(R(-4), b * x))));
      const auto too_small = yields & !(state[preconsolidation] > least);
      state[preconsolidation] = select(too_small, R(least), state[preconsolidation]);
      state[preconsolidation_rest] = select(too_small, R(0), state[preconsolidation_rest]);
    }
    if (any_of((gap > 0) | !(left >= 0))) {
      const R softest = a * least;  // Pa, modulus at no pressure; 0 once the law has failed
      const R parts =
          select(softest > 0, Kokkos::fmax(R(0), -left) / select(softest > 0, softest, R(1)), R(0));
      state[parted] = select(takes_part, select(gap > 0, Kokkos::fmax(opens, R(0)), R(0)) + parts, gap);
    }
    for (int k = 0; k < sym_size<Dim>; ++k) s[k] = select(takes_part, select(presses, next[k], R(0)), s[k]);
  }
};

}  // namespace mpm
