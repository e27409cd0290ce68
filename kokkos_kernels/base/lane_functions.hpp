#pragma once
// Exponentials and logarithms of lanes, for laws. They call no library, so that the compiler keeps them in
// vectors.

#include "base/lanes.hpp"

namespace mpm::impl {

/// Constants of the format of a real type, for exp and log.
template <class T>
struct RealFormat;
template <>
struct RealFormat<double> {
  static constexpr int k_mantissa_bits = 52, k_exp_terms = 14, k_log_terms = 11;
  static constexpr double k_to_integer = 0x1.8p52;  // a small number added to it is rounded to an integer
  static constexpr double k_least = -708, k_most = 709.7;  // arguments of exp with normal results
  static constexpr double k_ln2_high = 6.93147180369123816490e-01, k_ln2_low = 1.90821492927058770002e-10;
};
template <>
struct RealFormat<float> {
  static constexpr int k_mantissa_bits = 23, k_exp_terms = 8, k_log_terms = 5;
  static constexpr float k_to_integer = 0x1.8p23F;
  static constexpr float k_least = -87, k_most = 88.7F;
  static constexpr float k_ln2_high = 6.9313812256e-01F, k_ln2_low = 9.0580006145e-06F;
};

/// Calls f for every lane.
template <class T, int W, class F>
KOKKOS_FORCEINLINE_FUNCTION Lanes<T, W> by_lane(const Lanes<T, W>& a, F&& f) {
  Lanes<T, W> r;
  for (int l = 0; l < W; ++l) r.v[l] = f(T(a.v[l]));
  return r;
}

/// sum_k c(k) x^k for k = 0 ... n - 1, even and odd powers apart, which a processor adds at the same time.
template <int n, class R, class F>
KOKKOS_FORCEINLINE_FUNCTION R polynomial(const R& x, F&& c) {
  using T = typename R::real;
  const R square = x * x;
  R part[2] = {T(c(n - 1)), T(c(n - 2))};
  unrolled<n - 2>([&](auto k) { part[k % 2] = part[k % 2] * square + T(c(n - 3 - k)); });
  return n % 2 ? part[0] + x * part[1] : part[1] + x * part[0];
}

}  // namespace mpm::impl

namespace Kokkos {

template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> ceil(const mpm::Lanes<T, W>& a) {
  return mpm::impl::by_lane(a, [](T x) { return Kokkos::ceil(x); });
}
/// exp(x) - 1; lane by lane.
template <class T, int W>
[[gnu::noinline]] KOKKOS_FUNCTION mpm::Lanes<T, W> expm1(const mpm::Lanes<T, W>& a) {
  return mpm::impl::by_lane(a, [](T x) { return Kokkos::expm1(x); });
}

#ifdef MPM_PLAIN_LANES
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> exp(const mpm::Lanes<T, W>& a) {
  return mpm::impl::by_lane(a, [](T x) { return Kokkos::exp(x); });
}
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> log(const mpm::Lanes<T, W>& a) {
  return mpm::impl::by_lane(a, [](T x) { return Kokkos::log(x); });
}
#else
/// To two units of the last digit: exp(x) = 2^n exp(x - n ln 2), the latter by its series. Results
/// below the smallest normal number are 0.
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> exp(const mpm::Lanes<T, W>& x) {
  using R = mpm::Lanes<T, W>;
  using Of = mpm::impl::RealFormat<T>;
  using Bits = typename mpm::LaneMask<T, W>::Bits;
  const auto below = x < Of::k_least;
  const auto above = x > Of::k_most;
  const R bounded = mpm::select(below, Of::k_least, mpm::select(above, Of::k_most, x));
  const R shifted = bounded * T(1.44269504088896340736) + Of::k_to_integer, n = shifted - Of::k_to_integer;
  const R rest = (bounded - n * Of::k_ln2_high) - n * Of::k_ln2_low;
  const R series = mpm::impl::polynomial<Of::k_exp_terms>(rest, [](int k) {
    double factorial = 1;
    for (int i = 2; i <= k; ++i) factorial *= i;
    return 1 / factorial;
  });
  // the lowest bits of `shifted` are those of n, which is added to the exponent
  const R scaled(typename R::Values(Bits(series.v) + (Bits(shifted.v) << Of::k_mantissa_bits)));
  return mpm::select(below, T(0), mpm::select(above, Kokkos::Experimental::infinity_v<T>, scaled));
}
/// To three units of the last digit: x = 2^n m with m between 0.7 and 1.4, log(m) = 2 artanh((m - 1) / (m +
/// 1)), by its series.
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> log(const mpm::Lanes<T, W>& x) {
  using R = mpm::Lanes<T, W>;
  using Of = mpm::impl::RealFormat<T>;
  using Bits = typename mpm::LaneMask<T, W>::Bits;
  constexpr T root_half = T(0.70710678118654752440);
  R start = root_half;
  const Bits n = (Bits(x.v) - Bits(start.v)) >> Of::k_mantissa_bits;  // rounded down
  R to_integer = Of::k_to_integer;
  const R power = R(typename R::Values(Bits(to_integer.v) + n)) - to_integer;
  const R m(typename R::Values(Bits(x.v) - (n << Of::k_mantissa_bits)));
  const R s = (m - 1) / (m + 1);
  const R series = mpm::impl::polynomial<Of::k_log_terms>(s * s, [](int k) { return 2.0 / (2 * k + 1); });
  const R result = power * Of::k_ln2_high + (power * Of::k_ln2_low + s * series);
  constexpr T least = Kokkos::Experimental::norm_min_v<T>, most = Kokkos::Experimental::finite_max_v<T>;
  const R beyond = mpm::select(x == 0, -Kokkos::Experimental::infinity_v<T>,
                               mpm::select(x < 0, Kokkos::Experimental::quiet_NaN_v<T>, x));
  const auto is_normal = (x >= least) & (x <= most);
  return mpm::select(is_normal, result, beyond);
}
#endif

template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> log10(const mpm::Lanes<T, W>& x) {
  return Kokkos::log(x) * T(0.43429448190325182765);
}

}  // namespace Kokkos
