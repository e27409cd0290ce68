#pragma once
// Lanes: values of one real type on which one instruction of a processor works at once. Formulas that are
// templates on the real type take them as they take a number; where one would branch, they select.

#include <Kokkos_Core.hpp>
#include <cstring>
#include <type_traits>
#include <utility>

// nvcc has vectors, but not in functions of host and device.
#if defined(__CUDACC__) || !defined(__GNUC__)
#define MPM_PLAIN_LANES
#endif
#ifdef MPM_PLAIN_LANES
#include "base/plain_lanes.hpp"
#elif defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define MPM_SHUFFLES
#endif
#endif
/// Inlines a lambda into its caller, however many kernels a source has.
#ifdef MPM_PLAIN_LANES
#define MPM_INLINE_LAMBDA
#else
#define MPM_INLINE_LAMBDA __attribute__((always_inline))
#endif
#if defined(MPM_SHUFFLES) && defined(__AVX__)
#include <immintrin.h>
#endif

namespace mpm {

/// Whether lanes are arrays, and not vectors.
#ifdef MPM_PLAIN_LANES
inline constexpr bool k_plain_lanes = true;
#else
inline constexpr bool k_plain_lanes = false;
#endif

/// Bytes of the processor's widest vectors.
#if defined(__AVX512F__)
inline constexpr int k_vector_bytes = 64;
#elif defined(__AVX__)
inline constexpr int k_vector_bytes = 32;
#else
inline constexpr int k_vector_bytes = 16;
#endif
template <class T>
inline constexpr int native_lanes = k_vector_bytes / sizeof(T);

namespace impl {
#ifdef MPM_PLAIN_LANES
template <class T, int W>
struct VectorOf {
  using type = Plain<T, W>;
};
#else
/// The compiler's own vectors: it takes them apart where the processor's are shorter.
template <class T, int W>
struct VectorOf;
#define MPM_VECTOR_OF(T, W)                                     \
  template <>                                                   \
  struct VectorOf<T, W> {                                       \
    typedef T type __attribute__((vector_size(W * sizeof(T)))); \
  };
MPM_VECTOR_OF(float, 2)
MPM_VECTOR_OF(float, 4)
MPM_VECTOR_OF(float, 8)
MPM_VECTOR_OF(float, 16)
MPM_VECTOR_OF(double, 2)
MPM_VECTOR_OF(double, 4)
MPM_VECTOR_OF(double, 8)
MPM_VECTOR_OF(double, 16)
#undef MPM_VECTOR_OF
#endif
}  // namespace impl

/// Truth by lane: all bits of a lane, or none.
template <class T, int W>
struct LaneMask {
  using Bits = decltype(typename impl::VectorOf<T, W>::type{} < typename impl::VectorOf<T, W>::type{});
  Bits bits;
  KOKKOS_FORCEINLINE_FUNCTION bool operator[](int lane) const { return bits[lane] != 0; }
  KOKKOS_FORCEINLINE_FUNCTION friend LaneMask operator&(LaneMask a, LaneMask b) { return {a.bits & b.bits}; }
  KOKKOS_FORCEINLINE_FUNCTION friend LaneMask operator|(LaneMask a, LaneMask b) { return {a.bits | b.bits}; }
  KOKKOS_FORCEINLINE_FUNCTION friend LaneMask operator!(LaneMask a) { return {~a.bits}; }
};

/// W values of T. A single T stands for W equal ones.
template <class T, int W>
struct Lanes {
  using real = T;
  using Values = typename impl::VectorOf<T, W>::type;
  static constexpr int k_count = W;
  Values v;

  Lanes() = default;
  KOKKOS_FORCEINLINE_FUNCTION Lanes(T a) : v(a - Values{}) {}
  KOKKOS_FORCEINLINE_FUNCTION explicit Lanes(Values values) : v(values) {}
  /// From and to W values in memory.
  KOKKOS_FORCEINLINE_FUNCTION static Lanes load(const T* from) {
    Lanes a;
    memcpy(&a.v, from, sizeof a.v);
    return a;
  }
  KOKKOS_FORCEINLINE_FUNCTION void store(T* to) const { memcpy(to, &v, sizeof v); }
  KOKKOS_FORCEINLINE_FUNCTION T operator[](int lane) const { return v[lane]; }
  KOKKOS_FORCEINLINE_FUNCTION void set(int lane, T a) { v[lane] = a; }

  KOKKOS_FORCEINLINE_FUNCTION friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Lanes operator-(Lanes a) { return Lanes(-a.v); }
  KOKKOS_FORCEINLINE_FUNCTION Lanes& operator+=(Lanes b) { return v += b.v, *this; }
  KOKKOS_FORCEINLINE_FUNCTION Lanes& operator-=(Lanes b) { return v -= b.v, *this; }
  KOKKOS_FORCEINLINE_FUNCTION Lanes& operator*=(Lanes b) { return v *= b.v, *this; }
  KOKKOS_FORCEINLINE_FUNCTION Lanes& operator/=(Lanes b) { return v /= b.v, *this; }

  using Mask = LaneMask<T, W>;
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator<(Lanes a, Lanes b) { return {a.v < b.v}; }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator>(Lanes a, Lanes b) { return {a.v > b.v}; }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator<=(Lanes a, Lanes b) { return {a.v <= b.v}; }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator>=(Lanes a, Lanes b) { return {a.v >= b.v}; }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator==(Lanes a, Lanes b) { return {a.v == b.v}; }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator!=(Lanes a, Lanes b) { return {a.v != b.v}; }
};

namespace impl {
template <class R>
struct RealOf {
  using type = R;
};
template <class T, int W>
struct RealOf<Lanes<T, W>> {
  using type = T;
};
}  // namespace impl
/// The real type T of T, and of lanes of T.
template <class R>
using RealOf = typename impl::RealOf<R>::type;
template <class R>
inline constexpr bool is_lanes = !std::is_same_v<R, RealOf<R>>;
/// Result of a comparison: bool, or the truth by lane.
template <class R>
using Truth = decltype(std::declval<R>() < std::declval<R>());

/// Calls f with the constants 0 ... n - 1, so that loops over arrays of lanes leave them in registers.
template <class F, int... k>
KOKKOS_FORCEINLINE_FUNCTION void unrolled(F&& f, std::integer_sequence<int, k...>) {
  (f(std::integral_constant<int, k>{}), ...);
}
template <int n, class F>
KOKKOS_FORCEINLINE_FUNCTION void unrolled(F&& f) {
  unrolled(f, std::make_integer_sequence<int, n>{});
}

namespace impl {
#ifdef MPM_SHUFFLES
/// Lane l of what was N arrays of W values one after the other is value from(l) of them.
template <int N, class V, class From, int... l>
KOKKOS_FORCEINLINE_FUNCTION V collect(const V (&a)[N], From, std::integer_sequence<int, l...>) {
  constexpr int W = sizeof...(l);
  constexpr int second = N > 1 ? 1 : 0;
  V got = __builtin_shufflevector(a[0], a[second], (From::of(l) < 2 * W ? From::of(l) : 0)...);
  unrolled<(N > 2 ? N - 2 : 0)>([&](auto s) MPM_INLINE_LAMBDA {
    got = __builtin_shufflevector(got, a[s + 2], (From::of(l) / W == s + 2 ? W + From::of(l) % W : l)...);
  });
  return got;
}
template <int N, int W, int k>
struct Apart {  // value k of every group of N
  static constexpr int of(int l) { return l * N + k; }
};
template <int N, int W, int k>
struct Together {  // part k of groups of N, of which each member has its own lanes
  static constexpr int of(int l) { return (k * W + l) % N * W + (k * W + l) / N; }
};
/// The bits of all lanes together, in lane 0.
template <int half, class V, int... l>
KOKKOS_FORCEINLINE_FUNCTION V either(V a, std::integer_sequence<int, l...> lanes) {
  if constexpr (half == 0)
    return a;
  else
    return either<half / 2>(a | __builtin_shufflevector(a, a, int((l + half) % sizeof...(l))...), lanes);
}
#endif
}  // namespace impl

namespace impl {
/// Lanes as another real type.
template <class To, class T, int W>
KOKKOS_FORCEINLINE_FUNCTION Lanes<To, W> converted(Lanes<T, W> a) {
  if constexpr (std::is_same_v<To, T>) {
    return a;
  } else {
#ifdef MPM_PLAIN_LANES
    Lanes<To, W> to;
    for (int l = 0; l < W; ++l) to.set(l, static_cast<To>(a[l]));
    return to;
#else
    return Lanes<To, W>(__builtin_convertvector(a.v, typename VectorOf<To, W>::type));
#endif
  }
}
}  // namespace impl

/// a where the condition holds, else b; for numbers and by lane.
template <class T>
KOKKOS_FORCEINLINE_FUNCTION T select(bool condition, const T& a, const T& b) {
  return condition ? a : b;
}
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION Lanes<T, W> select(LaneMask<T, W> condition, std::type_identity_t<Lanes<T, W>> a,
                                               std::type_identity_t<Lanes<T, W>> b) {
#ifdef MPM_PLAIN_LANES
  for (int l = 0; l < W; ++l) a.v[l] = condition.bits[l] ? a.v[l] : b.v[l];
  return a;
#else
  return Lanes<T, W>(condition.bits ? a.v : b.v);
#endif
}
/// Whether a condition holds somewhere.
KOKKOS_FORCEINLINE_FUNCTION bool any_of(bool condition) { return condition; }
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION bool any_of(LaneMask<T, W> condition) {
#if defined(MPM_SHUFFLES) && defined(__AVX512F__)
  if constexpr (sizeof condition.bits == sizeof(__m512i)) {
    const __m512i bits = reinterpret_cast<__m512i>(condition.bits);
    return _mm512_test_epi64_mask(bits, bits) != 0;
  }
#endif
#if defined(MPM_SHUFFLES) && defined(__AVX__)
  if constexpr (sizeof condition.bits == sizeof(__m256i)) {
    const __m256i bits = reinterpret_cast<__m256i>(condition.bits);
    return _mm256_testz_si256(bits, bits) == 0;
  }
#endif
#ifdef MPM_SHUFFLES
  return impl::either<W / 2>(condition.bits, std::make_integer_sequence<int, W>{})[0] != 0;
#else
  bool any = false;
  for (int l = 0; l < W; ++l) any |= condition[l];
  return any;
#endif
}
/// Largest of all lanes.
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION T largest_of(Lanes<T, W> a) {
  T most = a[0];
  for (int l = 1; l < W; ++l) most = a[l] > most ? a[l] : most;
  return most;
}

namespace impl {
template <class To, class From, class A, int... l>
KOKKOS_FORCEINLINE_FUNCTION To pick(A a, From, std::integer_sequence<int, l...>) {
#ifdef MPM_SHUFFLES
  return To(__builtin_shufflevector(a.v, a.v, From::of(l)...));
#else
  To got;
  ((got.v[l] = a.v[From::of(l)]), ...);
  return got;
#endif
}
template <int w>
struct Repeated {
  static constexpr int of(int l) { return l % w; }
};
template <int first, int times>
struct Stretched {
  static constexpr int of(int l) { return first + l / times; }
};
template <int first>
struct Part {
  static constexpr int of(int l) { return first + l; }
};
}  // namespace impl

/// All lanes of a, and again, as often as W holds them.
template <int W, class T, int w>
KOKKOS_FORCEINLINE_FUNCTION Lanes<T, W> repeated(Lanes<T, w> a) {
  return impl::pick<Lanes<T, W>>(a, impl::Repeated<w>{}, std::make_integer_sequence<int, W>{});
}
/// Lane `first` of a w times, then the next one w times, and so on.
template <int W, int first, class T, int w>
KOKKOS_FORCEINLINE_FUNCTION Lanes<T, W> stretched(Lanes<T, w> a) {
  return impl::pick<Lanes<T, W>>(a, impl::Stretched<first, w>{}, std::make_integer_sequence<int, W>{});
}
/// w lanes of a from lane `first` on.
template <int w, int first, class T, int W>
KOKKOS_FORCEINLINE_FUNCTION Lanes<T, w> part_of(Lanes<T, W> a) {
  return impl::pick<Lanes<T, w>>(a, impl::Part<first>{}, std::make_integer_sequence<int, w>{});
}

/// Reads W groups of N values: a[k] gets value k of every group.
template <int N, class T, int W>
KOKKOS_FORCEINLINE_FUNCTION void load_groups(const T* from, Lanes<T, W> (&a)[N]) {
#ifdef MPM_SHUFFLES
  typename Lanes<T, W>::Values parts[N];
  for (int k = 0; k < N; ++k) parts[k] = Lanes<T, W>::load(from + k * W).v;
  unrolled<N>([&](auto k) MPM_INLINE_LAMBDA {
    a[k].v = impl::collect<N>(parts, impl::Apart<N, W, k>{}, std::make_integer_sequence<int, W>{});
  });
#else
  for (int l = 0; l < W; ++l)
    for (int k = 0; k < N; ++k) a[k].v[l] = from[l * N + k];
#endif
}
/// The inverse.
template <int N, class T, int W>
KOKKOS_FORCEINLINE_FUNCTION void store_groups(const Lanes<T, W> (&a)[N], T* to) {
#ifdef MPM_SHUFFLES
  using Values = typename Lanes<T, W>::Values;
  Values values[N];
  for (int k = 0; k < N; ++k) values[k] = a[k].v;
  unrolled<N>([&](auto k) MPM_INLINE_LAMBDA {
    constexpr impl::Together<N, W, k> from{};
    Lanes<T, W>(impl::collect<N>(values, from, std::make_integer_sequence<int, W>{})).store(to + k * W);
  });
#else
  for (int l = 0; l < W; ++l)
    for (int k = 0; k < N; ++k) to[l * N + k] = a[k].v[l];
#endif
}

}  // namespace mpm

// As Kokkos' own SIMD types do, so that a formula calls the same functions for numbers and for lanes.
namespace Kokkos {

template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> fmax(mpm::Lanes<T, W> a, mpm::Lanes<T, W> b) {
  return mpm::select(b > a, b, a);
}
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> fmax(T a, mpm::Lanes<T, W> b) {
  return fmax(mpm::Lanes<T, W>(a), b);
}
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> fmin(mpm::Lanes<T, W> a, mpm::Lanes<T, W> b) {
  return mpm::select(b < a, b, a);
}
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> fmin(T a, mpm::Lanes<T, W> b) {
  return fmin(mpm::Lanes<T, W>(a), b);
}
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> fabs(mpm::Lanes<T, W> a) {
  return mpm::select(a < T(0), -a, a);
}
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION mpm::Lanes<T, W> sqrt(mpm::Lanes<T, W> a) {
  mpm::Lanes<T, W> root;
  for (int l = 0; l < W; ++l) root.v[l] = Kokkos::sqrt(a.v[l]);
  return root;
}

}  // namespace Kokkos

namespace mpm {

/// A number in single precision, and a number of single precision as R: numbers, or lanes of as many.
KOKKOS_FORCEINLINE_FUNCTION float to_single(double a) { return static_cast<float>(a); }
KOKKOS_FORCEINLINE_FUNCTION float to_single(float a) { return a; }
template <class T, int W>
KOKKOS_FORCEINLINE_FUNCTION Lanes<float, W> to_single(Lanes<T, W> a) {
  return impl::converted<float>(a);
}
template <class R>
KOKKOS_FORCEINLINE_FUNCTION R to_real(float a) {
  return R(a);
}
template <class R, int W>
KOKKOS_FORCEINLINE_FUNCTION R to_real(Lanes<float, W> a) {
  return impl::converted<typename R::real>(a);
}

}  // namespace mpm
