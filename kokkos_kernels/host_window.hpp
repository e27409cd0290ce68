#pragma once
// The strategy `tile` on a processor: what its two passes over the particles of a patch share. A thread takes
// a patch, many particles at once; all of its memory is on its stack.

#include <atomic>
#include <vector>

#include "lanes.hpp"
#include "patches.hpp"
#include "shape_gimp.hpp"
#include "window.hpp"

namespace mpm {

/// Calls f(place, node, count) for every run of the window of a slot that lies together in both: from `place`
/// in the window, and from the number `node`, `count` nodes.
template <int Dim, class Around, class F>
void for_each_run(const Around& around, int slot, F&& f) {
  constexpr int edge = Patch<Dim>::edge, across = Patch<Dim>::window_edge, log_edge = Patch<Dim>::log_edge;
  for (int row = 0; row < Patch<Dim>::window; row += across) {
    const Coord<Dim> c = window_coord<Dim>(row);
    int which = 0, place = 0;  // as in number_at, which asks node by node
    for (int d = Dim - 1; d > 0; --d) {
      which = (which + (c[d] >> log_edge) + 1) * 3;
      place = (place + (c[d] & (edge - 1))) << log_edge;
    }
    const auto node = [&](int x) { return around(slot, which + x) * Patch<Dim>::cells + place; };
    f(row, node(0) + edge - 1, std::integral_constant<int, 1>{});
    f(row + 1, node(1), std::integral_constant<int, edge>{});
    f(row + 1 + edge, node(2), std::integral_constant<int, 2>{});
  }
}

/// Place in the window of the lowest node that particles of a cell of the patch reach.
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr int window_base(int place) {
  int n = 0;
  for (int d = Dim - 1; d >= 0; --d) n = n * Patch<Dim>::window_edge + coord_of<Dim>(place)[d];
  return n;
}

/// The first `count` < W of W groups of N values; the others repeat the last of them.
template <int N, class T, int W>
[[gnu::noinline]] KOKKOS_FUNCTION void load_some(const T* from, int count, Lanes<T, W> (&a)[N]) {
  T some[N * W];
  for (int l = 0; l < W; ++l) memcpy(some + l * N, from + (l < count ? l : count - 1) * N, N * sizeof(T));
  load_groups(some, a);
}
template <int N, class T, int W>
[[gnu::noinline]] KOKKOS_FUNCTION void store_some(const Lanes<T, W> (&a)[N], int count, T* to) {
  T some[N * W];
  store_groups(a, some);
  memcpy(to, some, count * N * sizeof(T));
}
/// A field of `count` particles from number p on; it has as many values of T as `a` has members.
template <class R, class Field, int N>
KOKKOS_FORCEINLINE_FUNCTION void load_field(const Field& field, int p, int count, R (&a)[N]) {
  const auto* const from = reinterpret_cast<const typename R::real*>(&field(p));
  if (count >= R::k_count)
    load_groups(from, a);
  else
    load_some(from, count, a);
}
template <class R, class Field, int N>
KOKKOS_FORCEINLINE_FUNCTION void store_field(const R (&a)[N], const Field& field, int p, int count) {
  auto* const to = reinterpret_cast<typename R::real*>(&field(p));
  if (count >= R::k_count)
    store_groups(a, to);
  else
    store_some(a, count, to);
}

/// A number that many threads change, alone on its cache line.
struct alignas(64) SharedCount {
  std::atomic<int> n{0};
};

/// Calls f(slot) for the slots that hold points, each by one thread. A thread begins with a part of each
/// colour that is always its own, and so in its cache, and then takes what others have left of theirs: on a
/// machine that is at work for others too, no thread waits long for one that was held up. If Writes, no
/// thread begins a colour before all slots of the last are done: slots at work at the same time share no
/// node. One thread alone needs no colours and takes the slots in the order of the points.
template <bool Writes, class Space, int Dim, class F>
void for_each_slot(const char* label, const Space& space, const Bins<Space>& bins, const F& f) {
  using Range = Kokkos::RangePolicy<Space, Kokkos::Schedule<Kokkos::Static>>;
  constexpr int cells = Patch<Dim>::cells;
  const auto begin = bins.begin;
  const auto by_colour = bins.by_colour;
  if constexpr (backend_of<Space> == Backend::serial) {
    if (bins.some)
      return Kokkos::parallel_for(label, Range(space, bins.colour_begin[0], bins.colour_begin[1]),
                                  [=](int n) { f(by_colour(n)); });
    Kokkos::parallel_for(label, Range(space, bins.first_slot, bins.last_slot), [=](int slot) {
      if (begin(slot * cells) < begin((slot + 1) * cells)) f(slot);
    });
  } else {
    constexpr int colours = Patch<Dim>::colours;
    const int threads = space.concurrency();
    const auto colour_begin = bins.colour_begin;
    const auto part_begin = [=](int colour, int thread) {
      const long from = colour_begin[colour], count = colour_begin[colour + 1] - from;
      return static_cast<int>(from + count * thread / threads);
    };
    std::vector<SharedCount> counts(colours * (threads + 1));
    SharedCount *const taken = counts.data(), *const done = taken + colours * threads;
    for (int n = 0; n < colours * threads; ++n) taken[n].n = part_begin(n / threads, n % threads);
    Kokkos::parallel_for(label, Range(space, 0, threads), [=](int thread) {
      for (int colour = 0; colour < colours; ++colour) {
        int mine = 0;
        for (int k = 0; k < threads; ++k) {
          const int whose = (thread + k) % threads, end = part_begin(colour, whose + 1);
          auto& next = taken[colour * threads + whose].n;
          // Looked at before it is changed: a line that nobody changes any more is read by all at once.
          for (int n; next < end && (n = next++) < end; ++mine) f(by_colour(n));
        }
        if constexpr (Writes) {
          constexpr int k_patience = 16384;  // looks, some 10 us, before the processor is left to others
          const int all = colour_begin[colour + 1] - colour_begin[colour];
          auto& ready = done[colour].n;
          if ((ready += mine) == all) ready.notify_all();
          for (int n, looks = 0; (n = ready) < all; ++looks)
            if (looks > k_patience) ready.wait(n);
        }
      }
    });
  }
}

/// Whether the points [from, to) are all of one body.
template <class Points_>
bool of_one_body(const Points_& points, int from, int to) {
  int others = 0;
  if constexpr (requires { points.body; })
    for (int p = from; p < to; ++p) others |= points.body(p) ^ points.body(from);
  return others == 0;
}

/// What bodies give `count` points from p on, by lane; without the material. same: all points are of one
/// body.
template <class R, class Points_>
KOKKOS_FORCEINLINE_FUNCTION BodyProperties<R> bodies_of(const Points_& points, int p, int count, bool same) {
  BodyProperties<R> body;
  const auto put = [&](int l, const auto& of) {
    body.mass.set(l, of.mass);
    body.half_length.l.set(l, of.half_length.l), body.half_length.inverse.set(l, of.half_length.inverse);
  };
  const auto all = [&](const auto& of) {
    body.mass = of.mass;
    body.half_length.l = of.half_length.l, body.half_length.inverse = of.half_length.inverse;
  };
  if constexpr (requires { points.body; }) {
    all(points.bodies(points.body(p)));
    for (int l = 1; l < count && !same; ++l) put(l, points.bodies(points.body(p + l)));
  } else {
    all(points);
  }
  return body;
}

}  // namespace mpm
