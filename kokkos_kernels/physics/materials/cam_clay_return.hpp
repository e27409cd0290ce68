#pragma once
// The return to the yield surface of modified Cam-Clay (Borja & Lee 1990, Borja 1991), in two invariants.

#include "base/types.hpp"

namespace mpm {

/// exp(x) - 1. Steps of a run are small, and there a few terms of the series have all digits.
template <class T>
KOKKOS_INLINE_FUNCTION T growth_of(T x) {
  constexpr T k_small = T(0.01);  // the first term left out is x^6/5040 of the sum
  if (Kokkos::fabs(x) < k_small)
    return x * (1 + x * (T(1.0 / 2) +
                         x * (T(1.0 / 6) + x * (T(1.0 / 24) + x * (T(1.0 / 120) + x * T(1.0 / 720))))));
  return Kokkos::expm1(x);
}

/// P(E) [Pa]: mean effective pressure, compression positive, over the elastic coordinate E = ln(P/least),
/// which grows by v/kappa de_v. Below `least` the line P = least (1 + E) goes on with the slope, so that both
/// the function and its inverse are smooth where P goes to zero. E itself is not formed where P stays above
/// `least`: in single precision its digits would not hold the increment of a step.
template <class T>
struct ElasticPressure {
  T least;  // Pa

  /// Change of the pressure [Pa] by a change of E, from a pressure `from` [Pa]. The pressure may end below
  /// zero, on the line below E = -1.
  KOKKOS_INLINE_FUNCTION T change(T from, T by) const {
    const T bounded = Kokkos::fmin(T(4), Kokkos::fmax(T(-4), by));
    const T growth = from * growth_of(bounded);
    if (from >= least && from + growth >= least) return growth;
    const T at = (from >= least ? Kokkos::log(from / least) : from / least - 1) + bounded;
    return (at >= 0 ? least * Kokkos::exp(at) : least * (1 + at)) - from;
  }
  /// dP/dE [Pa] at a pressure [Pa].
  KOKKOS_INLINE_FUNCTION T slope(T at) const { return Kokkos::fmax(at, least); }
};

/// A sub-increment of modified Cam-Clay that yields. Unknown are the multiplier l and the plastic volume
/// strain x (compression positive) with
///   x = l (2P - Pc),  q = q_t / (1 + 6 G l / M^2),  f = q^2/M^2 + P (P - Pc) = 0.
/// Pressures are over the preconsolidation pressure at the start of the sub-increment, and l is times it.
template <class T>
struct CamClayReturn {
  ElasticPressure<T> elastic;
  T start;           // -, P at the start
  T compression;     // -, volume strain of the sub-increment
  T a, b;            // -, v/kappa and v/(lambda - kappa)
  T trial_q, trial;  // -, q and P of the elastic trial
  T shear_modulus;   // -
  T slope2;          // -, M^2

  /// P, Pc and q for unknowns l and x, and the residuals of x and f.
  struct Point {
    T p, pc, q, divisor, of_x, of_f;
  };
  KOKKOS_INLINE_FUNCTION Point at(T l, T x) const {
    Point now;
    now.p = start + elastic.change(start, a * (compression - x));
    now.pc = 1 + growth_of(Kokkos::fmin(T(4), Kokkos::fmax(T(-4), b * x)));
    now.divisor = 1 + 6 * shear_modulus * l / slope2;
    now.q = trial_q / now.divisor;
    now.of_x = x - l * (2 * now.p - now.pc);
    now.of_f = now.q * now.q / slope2 + now.p * (now.p - now.pc);
    return now;
  }

  /// Newton's method on both unknowns at once. Of 1e5 random increments of 2e-4 and less, six iterations leave
  /// one in 1e5 that has not converged; the increments of a run need two or three. Returns whether the last
  /// change was so small that the error, about its square, is round-off.
  KOKKOS_INLINE_FUNCTION bool iterate(T& l, T& x) const {
    constexpr int k_iterations = 6;
    constexpr T k_largest = T(0.02);  // change of x
    constexpr T k_last = sizeof(T) == sizeof(double) ? T(1e-8) : T(3e-4);
    const T n = 2 * trial - 1;
    const T f = trial_q * trial_q / slope2 + trial * (trial - 1);
    const T steepness =
        12 * trial_q * trial_q * shear_modulus / (slope2 * slope2) + n * n * a * trial + trial * b * n;
    l = f / Kokkos::fmax(steepness, T(1e-6) * a);
    x = l * n / (1 + l * (2 * a * trial + b));
    MPM_ROLLED
    for (int n_done = 0; n_done < k_iterations; ++n_done) {
      const Point now = at(l, x);
      const T normal = 2 * now.p - now.pc, p_x = -a * elastic.slope(now.p), pc_x = b * now.pc;
      const T x_l = -normal, x_x = 1 - l * (2 * p_x - pc_x);
      const T f_l = -12 * shear_modulus * now.q * now.q / (slope2 * slope2 * now.divisor);
      const T f_x = p_x * normal - now.p * pc_x;
      T det = x_l * f_x - x_x * f_l;
      const T least = T(1e-6) * a;
      det = Kokkos::fabs(det) > least ? det : (det < 0 ? -least : least);
      const T by_l = (now.of_f * x_x - now.of_x * f_x) / det, by_x = (now.of_x * f_l - now.of_f * x_l) / det;
      const bool last = Kokkos::fabs(by_x) <= k_last * Kokkos::fabs(x) && Kokkos::fabs(by_l) <= k_last * l;
      x += Kokkos::fmin(k_largest, Kokkos::fmax(-k_largest, by_x));
      l = l + by_l > 0 ? l + by_l : l / 4;
      if (last) return true;
    }
    return false;
  }

  /// x for a given l: Newton's method on a function that only grows.
  KOKKOS_FUNCTION T volume_of(T l) const {
    constexpr int k_iterations = 25;
    constexpr T k_largest = T(0.02);
    T x = 0;
    MPM_ROLLED
    for (int k = 0; k < k_iterations; ++k) {
      const Point now = at(l, x);
      const T by = -now.of_x / (1 + l * (2 * a * elastic.slope(now.p) + b * now.pc));
      x += Kokkos::fmin(k_largest, Kokkos::fmax(-k_largest, by));
    }
    return x;
  }
  /// The safeguard: bisection of l, with x of each l.
  KOKKOS_FUNCTION void bisect(T& l, T& x) const {
    constexpr int k_doublings = 40, k_halvings = sizeof(T) == sizeof(double) ? 50 : 26;
    T low = 0, high = T(1e-6);
    MPM_ROLLED
    for (int k = 0; k < k_doublings && at(high, volume_of(high)).of_f > 0; ++k) low = high, high *= 2;
    MPM_ROLLED
    for (int k = 0; k < k_halvings; ++k) {
      const T middle = (low + high) / 2;
      (at(middle, volume_of(middle)).of_f > 0 ? low : high) = middle;
    }
    l = (low + high) / 2;
    x = volume_of(l);
  }

  struct Root {
    T l, x;
  };
  KOKKOS_INLINE_FUNCTION Root solve() const {
    constexpr T k_converged = T(1e-4);
    Root root;
    if (iterate(root.l, root.x)) return root;
    const Point now = at(root.l, root.x);
    if (!(Kokkos::fabs(now.of_x) < k_converged && Kokkos::fabs(now.of_f) < k_converged))
      bisect(root.l, root.x);
    return root;
  }
};

/// Its solution.
template <class T>
MPM_CALLED_FUNCTION typename CamClayReturn<T>::Root root_of(CamClayReturn<T> equations) {
  return equations.solve();
}

}  // namespace mpm
