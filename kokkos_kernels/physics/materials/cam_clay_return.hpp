#pragma once
// The return to the yield surface of modified Cam-Clay (Borja & Lee 1990, Borja 1991), in two invariants.

#include "physics/materials/material.hpp"

namespace mpm {

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

template <class T>
struct CamClayReturn;
template <class T>
MPM_CALLED_FUNCTION typename CamClayReturn<T>::Root bisected(CamClayReturn<T> equations);

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
  T inv_slope2;      // -, 1/M^2

  struct Root {
    T l, x;
  };
  /// P, Pc and q for unknowns l and x, 1/(1 + 6 G l / M^2), and the residuals of x and f.
  struct Point {
    T p, pc, q, share, of_x, of_f;
  };
  KOKKOS_INLINE_FUNCTION Point at(T l, T x) const {
    Point now;
    now.p = start + elastic.change(start, a * (compression - x));
    now.pc = 1 + growth_of(Kokkos::fmin(T(4), Kokkos::fmax(T(-4), b * x)));
    now.share = 1 / (1 + 6 * shear_modulus * inv_slope2 * l);
    now.q = trial_q * now.share;
    now.of_x = x - l * (2 * now.p - now.pc);
    now.of_f = now.q * now.q * inv_slope2 + now.p * (now.p - now.pc);
    return now;
  }

  /// Newton's method on both unknowns at once. Of 1e5 random increments of 2e-4 and less, six iterations
  /// leave one in 1e5 that has not converged; the increments of a run need two or three. Returns whether the
  /// last change, relative to the unknowns, was at most k_last; what is left is about its square.
  KOKKOS_INLINE_FUNCTION bool iterate(T& l, T& x) const {
    constexpr int k_iterations = 6;
    constexpr T k_largest = T(0.02);  // change of x
    constexpr T k_last = sizeof(T) == sizeof(double) ? T(1e-6) : T(1e-3);
    const T n = 2 * trial - 1;
    const T square = trial_q * trial_q * inv_slope2;
    const T f = square + trial * (trial - 1), falls = 12 * shear_modulus * inv_slope2;
    const T steepness = falls * square + n * n * a * trial + trial * b * n;
    const T divisor = Kokkos::fmax(steepness, T(1e-6) * a), divisor_x = divisor + f * (2 * a * trial + b);
    const T inverse = 1 / (divisor * divisor_x);
    l = f * divisor_x * inverse;
    x = f * n * divisor * inverse;
    MPM_ROLLED
    for (int n_done = 0; n_done < k_iterations; ++n_done) {
      const Point now = at(l, x);
      const T normal = 2 * now.p - now.pc, p_x = -a * elastic.slope(now.p), pc_x = b * now.pc;
      const T x_l = -normal, x_x = 1 - l * (2 * p_x - pc_x);
      const T f_l = -falls * now.q * now.q * inv_slope2 * now.share;
      const T f_x = p_x * normal - now.p * pc_x;
      const T det = x_l * f_x - x_x * f_l;
      const T least = T(1e-6) * a;
      const T inv_det = 1 / (Kokkos::fabs(det) > least ? det : (det < 0 ? -least : least));
      const T by_l = (now.of_f * x_x - now.of_x * f_x) * inv_det,
              by_x = (now.of_x * f_l - now.of_f * x_l) * inv_det;
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
  /// The multiplier and the plastic volume strain.
  KOKKOS_INLINE_FUNCTION Root solve() const {
    constexpr T k_converged = T(1e-4);
    Root root;
    if (iterate(root.l, root.x)) return root;
    const Point now = at(root.l, root.x);
    const bool converged = Kokkos::fabs(now.of_x) < k_converged && Kokkos::fabs(now.of_f) < k_converged;
    return converged ? root : bisected(*this);
  }
};

/// The safeguard: bisection of l, with x of each l.
template <class T>
MPM_CALLED_FUNCTION typename CamClayReturn<T>::Root bisected(CamClayReturn<T> equations) {
  constexpr int k_doublings = 40, k_halvings = sizeof(T) == sizeof(double) ? 50 : 26;
  const auto yields_at = [&](T l) { return equations.at(l, equations.volume_of(l)).of_f > 0; };
  T low = 0, high = T(1e-6);
  MPM_ROLLED
  for (int k = 0; k < k_doublings && yields_at(high); ++k) low = high, high *= 2;
  MPM_ROLLED
  for (int k = 0; k < k_halvings; ++k) {
    const T middle = (low + high) / 2;
    (yields_at(middle) ? low : high) = middle;
  }
  const T l = (low + high) / 2;
  return {l, equations.volume_of(l)};
}

}  // namespace mpm
