#pragma once
// Small vectors and tensors of the kernels.

#include <Kokkos_Core.hpp>

#include "base/lane_functions.hpp"
#include "base/lanes.hpp"

/// Before a loop whose body is long and seldom runs: it stays one. A GPU fetches the instructions of a kernel
/// from its memory, and copies of a loop's body cost more than they gain.
#ifdef __CUDACC__
#define MPM_ROLLED _Pragma("unroll 1")
#else
#define MPM_ROLLED
#endif

/// In lieu of KOKKOS_FUNCTION: a function with a long body that few threads come to. A GPU calls it, so that
/// the kernels around it need no registers for it. Arguments and results are few and are passed by value:
/// what is passed by reference goes through memory.
#ifdef __CUDA_ARCH__
#define MPM_CALLED_FUNCTION __noinline__ __host__ __device__
#else
#define MPM_CALLED_FUNCTION KOKKOS_FUNCTION
#endif

/// In lieu of KOKKOS_INLINE_FUNCTION: a part of a formula that particles seldom need. A processor calls it,
/// so that the vectors of the rest stay in registers.
#ifdef __CUDA_ARCH__
#define MPM_SELDOM_FUNCTION KOKKOS_INLINE_FUNCTION
#else
#define MPM_SELDOM_FUNCTION [[gnu::noinline]] KOKKOS_FUNCTION
#endif

/// In lieu of KOKKOS_INLINE_FUNCTION: a function that gives the same bits in every kernel. A compiler that
/// makes it a part of several kernels fuses other products and sums in each of them.
#ifdef __CUDA_ARCH__
#define MPM_SAME_BITS_FUNCTION MPM_CALLED_FUNCTION inline
#elif defined(__clang__)
#define MPM_SAME_BITS_FUNCTION [[gnu::noinline]] KOKKOS_FUNCTION inline
#else
#define MPM_SAME_BITS_FUNCTION [[gnu::noipa]] KOKKOS_FUNCTION inline
#endif

namespace mpm {

/// Alignment at which a group of n values is read at once: pairs, and fours up to 16 bytes.
template <class T, int n>
inline constexpr int group_alignment = n % 4 == 0 && 4 * sizeof(T) <= 16 ? 4 * sizeof(T)
                                       : n % 2 == 0                      ? 2 * sizeof(T)
                                                                         : sizeof(T);

/// Vector of Dim components.
template <class T, int Dim>
struct alignas(group_alignment<T, Dim>) Vector {
  T c[Dim];
  KOKKOS_INLINE_FUNCTION T& operator[](int d) { return c[d]; }
  KOKKOS_INLINE_FUNCTION const T& operator[](int d) const { return c[d]; }
};

/// Matrix of Dim rows and columns; component k of [] goes row by row.
template <class T, int Dim>
struct Matrix {
  T c[Dim * Dim];
  KOKKOS_INLINE_FUNCTION T& operator[](int k) { return c[k]; }
  KOKKOS_INLINE_FUNCTION const T& operator[](int k) const { return c[k]; }
  KOKKOS_INLINE_FUNCTION T& operator()(int i, int j) { return c[i * Dim + j]; }
  KOKKOS_INLINE_FUNCTION const T& operator()(int i, int j) const { return c[i * Dim + j]; }
};

/// Components of a symmetric tensor: 2D (plane strain) xx yy zz xy; 3D xx yy zz xy yz zx.
template <int Dim>
inline constexpr int sym_size = Dim == 2 ? 4 : 6;

/// Symmetric tensor of second order.
template <class T, int Dim>
struct alignas(group_alignment<T, sym_size<Dim>>) SymTensor {
  T c[sym_size<Dim>];
  KOKKOS_INLINE_FUNCTION T& operator[](int k) { return c[k]; }
  KOKKOS_INLINE_FUNCTION const T& operator[](int k) const { return c[k]; }
};

/// Place of component (i, j) in a SymTensor.
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr int sym_index(int i, int j) {
  return i == j ? i : (i + j == 1 ? 3 : (i + j == 3 ? 4 : 5));
}

/// Skew tensor (spin) as its independent components: 2D {w_xy}; 3D {w_xy, w_yz, w_zx}.
template <class T, int Dim>
struct Spin {
  T c[Dim == 2 ? 1 : 3];
};

/// Second moments of a particle's domain, as its independent components: 2D xx yy xy; 3D xx yy zz xy yz zx.
template <class T, int Dim>
struct alignas(group_alignment<T, Dim*(Dim + 1) / 2>) DomainMoments {
  T c[Dim * (Dim + 1) / 2];
  KOKKOS_INLINE_FUNCTION T& operator[](int k) { return c[k]; }
  KOKKOS_INLINE_FUNCTION const T& operator[](int k) const { return c[k]; }
};
/// Place of component (i, j) in DomainMoments.
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr int moment_index(int i, int j) {
  return Dim == 2 && i != j ? 2 : sym_index<Dim>(i, j);
}

/// Vector with every component equal to a.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Vector<T, Dim> filled(T a) {
  Vector<T, Dim> v;
  for (int d = 0; d < Dim; ++d) v[d] = a;
  return v;
}

template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T dot(const Vector<T, Dim>& a, const Vector<T, Dim>& b) {
  T s = a[0] * b[0];
  for (int d = 1; d < Dim; ++d) s += a[d] * b[d];
  return s;
}

/// a^n for a small whole n.
template <class T>
KOKKOS_INLINE_FUNCTION constexpr T power(T a, int n) {
  T s = 1;
  for (int k = 0; k < n; ++k) s *= a;
  return s;
}

}  // namespace mpm
