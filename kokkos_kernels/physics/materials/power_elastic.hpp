#pragma once
#include <array>
#include <cmath>
#include <limits>

#include "physics/materials/deviator.hpp"

namespace mpm {

/// Elasticity whose moduli grow with a power of the pressure P: K = bulk_modulus (X / pressure_reference)^n
/// with X = P + pressure_offset, constant where X is below pressure_min; G by the same factor. Exact in
/// volume; G of a step at the mean of the old and the new pressure, so that closed cycles of pressure and
/// shear together do not conserve energy. Jaumann rate of the Cauchy stress.
template <class T>
struct PowerElastic {
  using real = T;
  static constexpr const char* k_name = "power_elastic";
  static constexpr bool k_scalar_update = true, k_called_update = true, k_stiffness_changes = true;
  T bulk_modulus, pressure_reference, exponent, pressure_offset, pressure_min, poisson;
  T factor;       // Pa^(1-n), K / X^n
  T shear_ratio;  // -, G / K

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    using Law = PowerElastic;
    return std::to_array<Parameter<Law>>(
        {{"bulk_modulus", &Law::bulk_modulus, "Pa", "bulk modulus at pressure_reference", 1e-3, 1e15,
          required},
         {"pressure_reference", &Law::pressure_reference, "Pa", "pressure at which it is bulk_modulus", 1e-3,
          1e12, required},
         {"exponent", &Law::exponent, "-", "exponent of the pressure", 0, 1, required},
         {"pressure_offset", &Law::pressure_offset, "Pa", "attraction, added to the pressure", 0, 1e12, 0},
         {"pressure_min", &Law::pressure_min, "Pa",
          "pressure with offset below which the moduli are constant", 1e-3, 1e12, 1000},
         {"poisson", &Law::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required}});
  }
  /// Called once the parameters are set.
  void prepare() {
    factor = static_cast<T>(bulk_modulus / std::pow(double(pressure_reference), double(exponent)));
    shear_ratio = static_cast<T>(3 * (1 - 2.0 * poisson) / (2 * (1.0 + poisson)));
  }
  static constexpr std::array<StateVariable, 0> state() { return {}; }
  ParameterFault check() const { return {}; }
  std::array<double, 0> initial_state(const ParticleStart&) const { return {}; }

  /// K [Pa] at X = P + pressure_offset [Pa].
  KOKKOS_FUNCTION T bulk_modulus_at(T x) const {
    const T above = Kokkos::fmax(x, pressure_min);
    return factor * (exponent == T(0.5) ? Kokkos::sqrt(above) : power_of(above));
  }
  /// K + 4 G / 3 [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>& stress, const LawState<T, 0>&) const {
    return bulk_modulus_at(pressure_offset - mean_of(stress)) * (1 + shear_ratio * 4 / 3);
  }
  /// The wave modulus after the soil has been compressed by a volume strain.
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus_after(const SymTensor<T, Dim>& stress, const LawState<T, 0>&,
                                       T compression) const {
    const T x = pressure_offset - mean_of(stress);
    return bulk_modulus_at(x + growth(x, compression)) * (1 + shear_ratio * 4 / 3);
  }
  /// Undrained shear strength [Pa]; none here.
  KOKKOS_FUNCTION T shear_strength(const LawState<T, 0>&) const { return 0; }
  /// Energy that the soil can give back [J/m3]: of its volume that of the whole path from P = 0, and of shear
  /// that at the modulus of now.
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const LawState<T, 0>&) const {
    const T mean = mean_of(stress), x = pressure_offset - mean, shear = shear_stress_of(stress, mean);
    const double least = pressure_min, above = Kokkos::fmax(x, pressure_min),
                 start = Kokkos::fmax(pressure_offset, pressure_min), below = Kokkos::fmin(x, pressure_min),
                 start_below = Kokkos::fmin(pressure_offset, pressure_min);
    const double middle = (below + start_below) / 2 - pressure_offset;
    const double linear = (below - start_below) * middle / Kokkos::pow(least, double(exponent));
    return static_cast<T>((power_energy(above) - power_energy(start) + linear) / factor) +
           shear * shear / (2 * shear_ratio * bulk_modulus_at(x));
  }

  template <int Dim>
  KOKKOS_FUNCTION void update(SymTensor<T, Dim>& s, LawState<T, 0>&, const Increment<T, T, Dim>& by) const {
    s = rotated(s, by.spin);
    const T dilatation = by.strain[0] + by.strain[1] + by.strain[2];
    const T before = pressure_offset - mean_of(s), modulus = bulk_modulus_at(before);
    const T change = modulus * -dilatation, inverse = 1 / before, relative = change * inverse;
    T grown, middle;  // of X; K half way
    if (before >= pressure_min && before + change >= pressure_min && Kokkos::fabs(relative) < k_small) {
      grown = change * power_series(1 - exponent, relative);
      middle = modulus * modulus_series(grown * inverse / 2);
    } else {
      grown = growth(before, -dilatation);
      middle = bulk_modulus_at(before + grown / 2);
    }
    add_shear(s, by.strain, dilatation, shear_ratio * middle);
    for (int d = 0; d < 3; ++d) s[d] -= grown;
  }

  /// Growth of X [Pa] from x by a volume strain, compression positive: exact, and to round-off of the growth,
  /// which may be far below that of X. Below pressure_min the modulus is constant.
  MPM_CALLED_FUNCTION T growth(T x, T compression) const {
    const T least = pressure_min, slope = bulk_modulus_at(least);  // Pa
    if (x < least) {
      const T straight = slope * compression;
      if (x + straight <= least) return straight;
      const T rest = compression - (least - x) / slope;
      return (least - x) + power_growth(least, slope, rest);
    }
    const T modulus = bulk_modulus_at(x);
    // The modulus only falls with X, so that X falls by no more than at the modulus of now.
    if (x + modulus * compression >= least) return power_growth(x, modulus, compression);
    // the strain at which X falls to pressure_min
    const T rest = 1 - exponent, ratio = Kokkos::log(x / least);
    const T span = x / modulus * (rest == 0 ? ratio : -Kokkos::expm1(-rest * ratio) / rest);
    if (compression >= -span) return power_growth(x, modulus, compression);
    return (least - x) + slope * (compression + span);
  }

 private:
  static constexpr T k_small = T(0.01);  // of changes for which seven terms of a series have all digits

  MPM_CALLED_FUNCTION T power_of(T x) const { return Kokkos::exp(exponent * Kokkos::log(x)); }
  /// ((1 + r c)^(1/r) - 1) / c for a small c, 0 <= r <= 1: terms c^k/(k + 1)! (1 - r) ... (1 - k r).
  KOKKOS_INLINE_FUNCTION static T power_series(T r, T c) {
    T sum = 1;
    for (int k = 6; k > 0; --k) sum = 1 + (1 - k * r) * T(1.0 / (k + 1)) * c * sum;
    return sum;
  }
  /// (1 + d)^n for a small d, with n the exponent: terms d^k/k! n ... (n - k + 1).
  KOKKOS_INLINE_FUNCTION T modulus_series(T d) const {
    T sum = 1;
    for (int k = 7; k > 0; --k) sum = 1 + (exponent - (k - 1)) * T(1.0 / k) * d * sum;
    return sum;
  }
  /// Growth of X [Pa] above pressure_min from x, where K is `modulus` [Pa]: X' = (X^(1-n) + (1-n) c dv)^
  /// (1/(1-n)), n = 1: X exp(c dv). A step changes X by a factor of at most e^20,
  /// so that what is finite stays finite.
  KOKKOS_FUNCTION T power_growth(T x, T modulus, T compression) const {
    constexpr T k_most = 20, k_least = -0.999999;  // of rest * change: X' > 0, which `span` grants otherwise
    const T change = modulus * compression / x;
    const T rest = 1 - exponent;
    const T log_ratio = rest == 0 ? change : Kokkos::log1p(Kokkos::fmax(k_least, rest * change)) / rest;
    return x * Kokkos::expm1(Kokkos::fmin(k_most, Kokkos::fmax(-k_most, log_ratio)));
  }
  /// c times the integral of P dv [Pa^(2-n)] up to X, but for a constant.
  KOKKOS_FUNCTION double power_energy(double x) const {
    const double n = exponent, a = pressure_offset;
    if (1 - n < 1e-6) return x - a * Kokkos::log(x);
    return Kokkos::pow(x, 2 - n) / (2 - n) - a * Kokkos::pow(x, 1 - n) / (1 - n);
  }
};

}  // namespace mpm
