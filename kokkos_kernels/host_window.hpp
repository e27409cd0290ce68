#pragma once
// The strategy `tile` on a processor: what its two passes over the particles of a patch share. A thread takes a
// patch, many particles at once; all of its memory is on its stack.

#include "lanes.hpp"
#include "patches.hpp"
#include "shape_gimp.hpp"
#include "window.hpp"

namespace mpm {

/// Particles that a thread keeps in its cache at once; whole vectors.
template <class T>
inline constexpr int k_host_stage = 2048 / sizeof(T);

/// Calls f(place, node, count) for every run of the window of a slot that lies together in both: from `place`
/// in the window, and from the number `node`, `count` nodes.
template <int Dim, class Around, class F>
void for_each_run(const Around& around, int slot, F&& f) {
  constexpr int edge = Patch<Dim>::edge, across = Patch<Dim>::window_edge;
  for (int row = 0; row < Patch<Dim>::window; row += across) {
    Coord<Dim> c = window_coord<Dim>(row);
    f(row, number_at<Around, Dim>(around, slot, c), 1);
    c[0] = 0;
    f(row + 1, number_at<Around, Dim>(around, slot, c), edge);
    c[0] = edge;
    f(row + 1 + edge, number_at<Around, Dim>(around, slot, c), 2);
  }
}

/// Place in the window of the lowest node that particles of a cell of the patch reach.
template <int Dim>
constexpr int window_base(int place) {
  int n = 0;
  for (int d = Dim - 1; d >= 0; --d) n = n * Patch<Dim>::window_edge + coord_of<Dim>(place)[d];
  return n;
}

/// The first `count` of W groups of N values; the others repeat the last of them.
template <int N, class T, int W>
void load_some(const T* from, int count, Lanes<T, W> (&a)[N]) {
  if (count >= W) return load_groups(from, a);
  T some[N * W];
  for (int l = 0; l < W; ++l)
    memcpy(some + l * N, from + (l < count ? l : count - 1) * N, N * sizeof(T));
  load_groups(some, a);
}
template <int N, class T, int W>
void store_some(const Lanes<T, W> (&a)[N], int count, T* to) {
  if (count >= W) return store_groups(a, to);
  T some[N * W];
  store_groups(a, some);
  memcpy(to, some, count * N * sizeof(T));
}
/// A field of the particles from number p on; Value is made of as many T as `a` has members.
template <class R, class Field, int N>
void load_field(const Field& field, int p, int count, R (&a)[N]) {
  load_some<N>(reinterpret_cast<const typename R::real*>(&field(p)), count, a);
}
template <class R, class Field, int N>
void store_field(const R (&a)[N], const Field& field, int p, int count) {
  store_some<N>(a, count, reinterpret_cast<typename R::real*>(&field(p)));
}

/// The half lengths of W particles by lane, from `count` of them: half_of(l).
template <class R, class HalfOf>
HalfLength<R> half_lengths(int count, HalfOf&& half_of) {
  using T = typename R::real;
  const HalfLength<T> first = half_of(0);
  HalfLength<R> half;
  half.l = first.l, half.inverse = first.inverse;
  bool alike = true;
  for (int l = 1; l < count; ++l) alike &= half_of(l).l == first.l;
  for (int l = 1; l < count && !alike; ++l) half.l.set(l, half_of(l).l), half.inverse.set(l, half_of(l).inverse);
  return half;
}

}  // namespace mpm
