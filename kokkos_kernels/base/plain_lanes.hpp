#pragma once
// Lanes where the compiler has no vectors of its own for functions that a GPU could call (nvcc): an array,
// with loops that the host's compiler may turn into vectors.

#include <Kokkos_Core.hpp>

namespace mpm::impl {

template <class T, int W>
struct alignas(W * sizeof(T)) Plain {
  T value[W];
  KOKKOS_FORCEINLINE_FUNCTION T& operator[](int l) { return value[l]; }
  KOKKOS_FORCEINLINE_FUNCTION const T& operator[](int l) const { return value[l]; }

  /// f of every lane of a and b.
  template <class To = T, class F>
  KOKKOS_FORCEINLINE_FUNCTION static Plain<To, W> each(const Plain& a, const Plain& b, F&& f) {
    Plain<To, W> r;
    for (int l = 0; l < W; ++l) r[l] = f(a[l], b[l]);
    return r;
  }
  using P = const Plain&;
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator+(P a, P b) {
    return each(a, b, [](T x, T y) { return x + y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator-(P a, P b) {
    return each(a, b, [](T x, T y) { return x - y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator*(P a, P b) {
    return each(a, b, [](T x, T y) { return x * y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator/(P a, P b) {
    return each(a, b, [](T x, T y) { return x / y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator-(T a, P b) {
    return each(b, b, [=](T x, T) { return a - x; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator-(P a) {
    return each(a, a, [](T x, T) { return -x; });
  }
  KOKKOS_FORCEINLINE_FUNCTION Plain& operator+=(P b) { return *this = *this + b; }
  KOKKOS_FORCEINLINE_FUNCTION Plain& operator-=(P b) { return *this = *this - b; }
  KOKKOS_FORCEINLINE_FUNCTION Plain& operator*=(P b) { return *this = *this * b; }
  KOKKOS_FORCEINLINE_FUNCTION Plain& operator/=(P b) { return *this = *this / b; }

  using Truth = Plain<bool, W>;
  KOKKOS_FORCEINLINE_FUNCTION friend Truth operator<(P a, P b) {
    return Plain::each<bool>(a, b, [](T x, T y) { return x < y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Truth operator>(P a, P b) { return b < a; }
  KOKKOS_FORCEINLINE_FUNCTION friend Truth operator<=(P a, P b) {
    return Plain::each<bool>(a, b, [](T x, T y) { return x <= y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Truth operator>=(P a, P b) { return b <= a; }
  KOKKOS_FORCEINLINE_FUNCTION friend Truth operator==(P a, P b) {
    return Plain::each<bool>(a, b, [](T x, T y) { return x == y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Truth operator!=(P a, P b) { return ~(a == b); }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator&(P a, P b) {
    return each(a, b, [](T x, T y) { return x && y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator|(P a, P b) {
    return each(a, b, [](T x, T y) { return x || y; });
  }
  KOKKOS_FORCEINLINE_FUNCTION friend Plain operator~(P a) {
    return each(a, a, [](T x, T) { return !x; });
  }
};

}  // namespace mpm::impl
