#pragma once
// Principal stresses and their axes, for laws that return to their yield surface in principal stress space.

#include "physics/materials/material.hpp"

namespace mpm {

/// Three values in descending order, and the swaps that put them there.
template <class R>
struct Sorted3 {
  R value[3];
  Truth<R> swapped[3];  // 0 and 1, then 1 and 2, then 0 and 1
};

template <class R>
KOKKOS_INLINE_FUNCTION void swap_if(const Truth<R>& condition, R& a, R& b) {
  const R was = a;
  a = select(condition, b, a);
  b = select(condition, was, b);
}

template <class R>
KOKKOS_INLINE_FUNCTION Sorted3<R> sorted_down(const R (&v)[3]) {
  Sorted3<R> s{{v[0], v[1], v[2]}, {}};
  s.swapped[0] = s.value[0] < s.value[1];
  swap_if(s.swapped[0], s.value[0], s.value[1]);
  s.swapped[1] = s.value[1] < s.value[2];
  swap_if(s.swapped[1], s.value[1], s.value[2]);
  s.swapped[2] = s.value[0] < s.value[1];
  swap_if(s.swapped[2], s.value[0], s.value[1]);
  return s;
}

/// Values in the order of `s.value`, put back into the order before the sort.
template <class R>
KOKKOS_INLINE_FUNCTION void unsort(const Sorted3<R>& s, R (&v)[3]) {
  swap_if(s.swapped[2], v[0], v[1]);
  swap_if(s.swapped[1], v[1], v[2]);
  swap_if(s.swapped[0], v[0], v[1]);
}

/// Principal values [Pa] of the deviator, not sorted, and their axes. Values without the mean stress keep the
/// digits of the deviator where the mean is many times the strength. 2D: two in the plane, the larger first,
/// then zz.
template <class R, int Dim>
struct Principal;

template <class R>
struct Principal<R, 2> {
  R value[3];
  R cos_2a, sin_2a;  // a: angle from the x axis to the axis of value[0]
};
template <class R>
struct Principal<R, 3> {
  R value[3];
  R axis[3][3];  // axis[i][k]: component i of the axis of value[k]
};

/// Closed form.
template <class R>
KOKKOS_INLINE_FUNCTION Principal<R, 2> principal_of(const SymTensor<R, 2>& s, R) {
  const R in_plane = ((s[0] - s[2]) + (s[1] - s[2])) * RealOf<R>(1.0 / 6), half = (s[0] - s[1]) / 2;
  const R radius = Kokkos::sqrt(half * half + s[3] * s[3]);
  const auto has_axes = radius > 0;
  const R divisor = select(has_axes, radius, R(1));
  return {{in_plane + radius, in_plane - radius, -2 * in_plane},
          select(has_axes, half / divisor, R(1)),
          s[3] / divisor};
}

/// One rotation of Jacobi's method in the plane of axes p and q, which takes a_pq to zero; r is the third
/// axis. No division by a_pq: the tangent of the angle is 2 a_pq / (d + sqrt(d^2 + 4 a_pq^2)), d = a_qq -
/// a_pp.
template <int p, int q, class R>
KOKKOS_INLINE_FUNCTION void jacobi_rotation(SymTensor<R, 3>& a, R (&axis)[3][3]) {
  constexpr int r = 3 - p - q, pq = sym_index<3>(p, q), rp = sym_index<3>(r, p), rq = sym_index<3>(r, q);
  const R d = a[q] - a[p], twice = 2 * a[pq];
  const R divisor = Kokkos::fabs(d) + Kokkos::sqrt(d * d + twice * twice);
  const R t = select(divisor > 0, select(d < 0, -twice, twice) / divisor, R(0));
  const R c = 1 / Kokkos::sqrt(1 + t * t), s = t * c;
  a[p] -= t * a[pq];
  a[q] += t * a[pq];
  a[pq] = 0;
  const R a_rp = a[rp], a_rq = a[rq];
  a[rp] = c * a_rp - s * a_rq;
  a[rq] = s * a_rp + c * a_rq;
  for (int i = 0; i < 3; ++i) {
    const R v_p = axis[i][p], v_q = axis[i][q];
    axis[i][p] = c * v_p - s * v_q;
    axis[i][q] = s * v_p + c * v_q;
  }
}

/// Jacobi's method on the deviator (of a stress of this mean), divided by its largest component. The sweeps
/// are fixed in number, so that threads of a GPU stay together: of a million random tensors, three sweeps
/// leave up to 4e-5 beside the diagonal, four 3e-20. A form with the arc cosine would lose half of the digits
/// where two values are nearly equal.
template <class R>
KOKKOS_INLINE_FUNCTION Principal<R, 3> principal_of(const SymTensor<R, 3>& s, R mean) {
  constexpr int k_sweeps = 4;
  SymTensor<R, 3> a;
  R largest = 0;
  for (int k = 0; k < 6; ++k) {
    a[k] = k < 3 ? s[k] - mean : s[k];
    largest = Kokkos::fmax(largest, Kokkos::fabs(a[k]));
  }
  const R divisor = select(largest > 0, largest, R(1));
  for (int k = 0; k < 6; ++k) a[k] /= divisor;
  Principal<R, 3> of{{}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  MPM_ROLLED
  for (int sweep = 0; sweep < k_sweeps; ++sweep) {
    jacobi_rotation<0, 1>(a, of.axis);
    jacobi_rotation<1, 2>(a, of.axis);
    jacobi_rotation<0, 2>(a, of.axis);
  }
  for (int k = 0; k < 3; ++k) of.value[k] = divisor * a[k];
  return of;
}

/// Normal stresses n_k . s n_k along axes.
template <class R>
KOKKOS_INLINE_FUNCTION void along_axes(const SymTensor<R, 2>& s, const Principal<R, 2>& of, R (&along)[3]) {
  const R mean = (s[0] + s[1]) / 2, half = (s[0] - s[1]) / 2 * of.cos_2a + s[3] * of.sin_2a;
  along[0] = mean + half, along[1] = mean - half, along[2] = s[2];
}
template <class R>
KOKKOS_INLINE_FUNCTION void along_axes(const SymTensor<R, 3>& s, const Principal<R, 3>& of, R (&along)[3]) {
  for (int k = 0; k < 3; ++k) {
    along[k] = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) along[k] += s[sym_index<3>(i, j)] * of.axis[i][k] * of.axis[j][k];
  }
}

/// Adds sum_k by[k] n_k n_k^T to s. Where two values are nearly equal their axes n_k are arbitrary, but then
/// their corrections are nearly equal too, so that the sum is smooth.
template <class R>
KOKKOS_INLINE_FUNCTION void add_along_axes(SymTensor<R, 2>& s, const Principal<R, 2>& of, const R (&by)[3]) {
  const R mean = (by[0] + by[1]) / 2, half = (by[0] - by[1]) / 2;
  s[0] += mean + half * of.cos_2a;
  s[1] += mean - half * of.cos_2a;
  s[2] += by[2];
  s[3] += half * of.sin_2a;
}
template <class R>
KOKKOS_INLINE_FUNCTION void add_along_axes(SymTensor<R, 3>& s, const Principal<R, 3>& of, const R (&by)[3]) {
  for (int k = 0; k < 3; ++k) {
    const R n[3] = {of.axis[0][k], of.axis[1][k], of.axis[2][k]};
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) s[sym_index<3>(i, j)] += by[k] * n[i] * n[j];
  }
}

}  // namespace mpm
