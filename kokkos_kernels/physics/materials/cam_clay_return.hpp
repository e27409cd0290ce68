#pragma once
// The return to the yield surface of modified Cam-Clay (Borja & Lee 1990, Borja 1991), in two invariants.

#include "physics/materials/material.hpp"

namespace mpm {

/// P(E) [Pa]: mean effective pressure, compression positive, over the elastic coordinate E = ln(P/least),
/// which grows by v/kappa de_v. Below `least` the line P = least (1 + E) goes on with the slope, so that both
/// the function and its inverse are smooth where P goes to zero. E itself is not formed where P stays above
/// `least`: in single precision its digits would not hold the increment of a step.
template <class R>
struct ElasticPressure {
  R least;  // Pa

  /// Change of the pressure [Pa] by a change of E, from a pressure `from` [Pa]. The pressure may end below
  /// zero, on the line below E = -1.
  KOKKOS_FORCEINLINE_FUNCTION R change(const R& from, const R& by) const {
    const R bounded = Kokkos::fmin(R(4), Kokkos::fmax(R(-4), by));
    const R growth = from * growth_of(bounded);
    const Truth<R> above = (from >= least) & (from + growth >= least);
    if (!any_of(!above)) return growth;
    return select(above, growth, change_on_line(from, bounded));
  }
  /// The change where it begins or ends on the line.
  MPM_SELDOM_FUNCTION R change_on_line(const R& from, const R& by) const {
    const R ratio = from / least;
    const R at = select(from >= least, Kokkos::log(ratio), ratio - 1) + by;
    return select(at >= 0, least * Kokkos::exp(at), least * (1 + at)) - from;
  }
  /// dP/dE [Pa] at a pressure [Pa].
  KOKKOS_INLINE_FUNCTION R slope(const R& at) const { return Kokkos::fmax(at, least); }
};

template <class R>
struct CamClayReturn;
template <class T>
MPM_CALLED_FUNCTION typename CamClayReturn<T>::Root bisected(CamClayReturn<T> equations);

/// A sub-increment of modified Cam-Clay that yields. Unknown are the multiplier l and the plastic volume
/// strain x (compression positive) with
///   x = l (2P - Pc),  q = q_t / (1 + 6 G l / M^2),  f = q^2/M^2 + P (P - Pc) = 0.
/// Pressures are over the preconsolidation pressure at the start of the sub-increment, and l is times it.
template <class R>
struct CamClayReturn {
  using T = RealOf<R>;
  ElasticPressure<R> elastic;
  R start;           // -, P at the start
  R compression;     // -, volume strain of the sub-increment
  R a, b;            // -, v/kappa and v/(lambda - kappa)
  R trial_q, trial;  // -, q and P of the elastic trial
  R shear_modulus;   // -
  T inv_slope2;      // -, 1/M^2

  struct Root {
    R l, x;
  };
  /// P, Pc and q for unknowns l and x, 1/(1 + 6 G l / M^2), and the residuals of x and f.
  struct Point {
    R p, pc, q, share, of_x, of_f;
  };
  KOKKOS_FORCEINLINE_FUNCTION Point at(const R& l, const R& x) const {
    Point now;
    now.p = start + elastic.change(start, a * (compression - x));
    now.pc = 1 + growth_of(Kokkos::fmin(R(4), Kokkos::fmax(R(-4), b * x)));
    now.share = 1 / (1 + 6 * shear_modulus * inv_slope2 * l);
    now.q = trial_q * now.share;
    now.of_x = x - l * (2 * now.p - now.pc);
    now.of_f = now.q * now.q * inv_slope2 + now.p * (now.p - now.pc);
    return now;
  }

  /// Newton's method on both unknowns at once, for particles that `iterate`. It ends where the last change of
  /// l and x was at most k_last times l, so that about the square of this is left, or where f was 0 to
  /// round-off. Of 1e5 random increments of 2e-4 and less, six iterations leave one in 1e5 that has not
  /// converged; the increments of a run need one or two, three in double precision. Returns whether a
  /// particle has not converged.
  KOKKOS_INLINE_FUNCTION Truth<R> iterate(const Truth<R>& iterates, R& l, R& x) const {
    constexpr int k_iterations = 6;
    const R k_largest = T(0.02);  // change of x
    constexpr T k_last = sizeof(T) == sizeof(double) ? T(1e-6) : T(1e-3);
    constexpr T k_round_off = 4 * Kokkos::Experimental::epsilon_v<T>;  // of f, whose terms are about 1
    const R n = 2 * trial - 1, least = T(1e-6) * a;
    const R square = trial_q * trial_q * inv_slope2, falls = 12 * shear_modulus * inv_slope2;
    const R f = square + trial * (trial - 1);
    const R steepness = falls * square + n * n * a * trial + trial * b * n;
    const R divisor = Kokkos::fmax(steepness, least), divisor_x = divisor + f * (2 * a * trial + b);
    const R inverse = 1 / (divisor * divisor_x);
    l = f * divisor_x * inverse;
    x = f * n * divisor * inverse;
    Truth<R> goes_on = iterates;
    MPM_ROLLED
    for (int n_done = 0; n_done < k_iterations; ++n_done) {
      const Point now = at(l, x);
      const R normal = 2 * now.p - now.pc, p_x = -a * elastic.slope(now.p), pc_x = b * now.pc;
      const R x_l = -normal, x_x = 1 - l * (2 * p_x - pc_x);
      const R f_l = -falls * now.q * now.q * inv_slope2 * now.share;
      const R f_x = p_x * normal - now.p * pc_x;
      const R det = x_l * f_x - x_x * f_l;
      const R inv_det = 1 / select(Kokkos::fabs(det) > least, det, select(det < 0, -least, least));
      const R by_l = (now.of_f * x_x - now.of_x * f_x) * inv_det,
              by_x = (now.of_x * f_l - now.of_f * x_l) * inv_det;
      const Truth<R> last =
          (Kokkos::fmax(Kokkos::fabs(by_x), Kokkos::fabs(by_l)) <= k_last * l) |
          ((Kokkos::fabs(now.of_f) <= k_round_off) & (Kokkos::fabs(now.of_x) <= k_last * l));
      x = select(goes_on, x + Kokkos::fmin(k_largest, Kokkos::fmax(-k_largest, by_x)), x);
      l = select(goes_on, select(l + by_l > 0, l + by_l, l / 4), l);
      goes_on = goes_on & !last;
      if (!any_of(goes_on)) break;
    }
    return goes_on;
  }

  /// x for a given l: Newton's method on a function that only grows.
  KOKKOS_FUNCTION R volume_of(const R& l) const {
    constexpr int k_iterations = 25;
    const R k_largest = T(0.02);
    R x = 0;
    MPM_ROLLED
    for (int k = 0; k < k_iterations; ++k) {
      const Point now = at(l, x);
      const R by = -now.of_x / (1 + l * (2 * a * elastic.slope(now.p) + b * now.pc));
      x += Kokkos::fmin(k_largest, Kokkos::fmax(-k_largest, by));
    }
    return x;
  }
  /// The multiplier and the plastic volume strain of particles that yield.
  KOKKOS_INLINE_FUNCTION Root solve(const Truth<R>& yields) const {
    const R k_converged = T(1e-4);
    Root root;
    Truth<R> is_off = iterate(yields, root.l, root.x);
    if (!any_of(is_off)) return root;
    const Point now = at(root.l, root.x);
    is_off = is_off & !((Kokkos::fabs(now.of_x) < k_converged) & (Kokkos::fabs(now.of_f) < k_converged));
    if (!any_of(is_off)) return root;
    if constexpr (is_lanes<R>) {
      for (int l = 0; l < R::k_count; ++l) {
        if (!is_off[l]) continue;
        const auto own = bisected(of_lane(l));
        root.l.set(l, own.l), root.x.set(l, own.x);
      }
      return root;
    } else {
      return bisected(*this);
    }
  }
  /// The equations of one lane.
  KOKKOS_INLINE_FUNCTION CamClayReturn<T> of_lane(int n) const {
    return {{elastic.least[n]}, start[n], compression[n],   a[n],      b[n],
            trial_q[n],         trial[n], shear_modulus[n], inv_slope2};
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
