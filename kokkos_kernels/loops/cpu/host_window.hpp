#pragma once
// The strategy `tile` on a processor: helpers of its two passes over the particles of a patch. A thread
// processes a patch, many particles at once, with all of its memory on the stack.

#include <atomic>
#include <vector>

#include "base/lanes.hpp"
#include "data/patches.hpp"
#include "loops/window.hpp"
#include "physics/domain.hpp"
#include "physics/ring_domain.hpp"
#include "physics/shape_gimp.hpp"

namespace mpm {

/// Calls f(place, node, count) for every run of nodes that is contiguous in the window of a slot and in the
/// nodal fields: `count` nodes from `place` in the window and from number `node` of the fields on.
template <int Dim, class Neighbours, class F>
void for_each_run(const Neighbours& neighbours, int slot, F&& f) {
  constexpr int edge = Patch<Dim>::edge, across = Patch<Dim>::window_edge, log_edge = Patch<Dim>::log_edge;
  for (int row = 0; row < Patch<Dim>::window; row += across) {
    const Coord<Dim> c = window_coord<Dim>(row);
    int which = 0, place = 0;  // as in number_at, which asks node by node
    for (int d = Dim - 1; d > 0; --d) {
      which = (which + (c[d] >> log_edge) + 1) * 3;
      place = (place + (c[d] & (edge - 1))) << log_edge;
    }
    const auto node = [&](int x) { return neighbours(slot, which + x) * Patch<Dim>::cells + place; };
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
/// A field of one value a particle, or of a vector or tensor.
template <class Value, class Field>
KOKKOS_FORCEINLINE_FUNCTION void load_field(const Field& field, int p, int count, Value& a) {
  if constexpr (requires { a.c; })
    load_field(field, p, count, a.c);
  else
    load_field(field, p, count, reinterpret_cast<Value(&)[1]>(a));
}
template <class R, class Field, int N>
KOKKOS_FORCEINLINE_FUNCTION void store_field(const R (&a)[N], const Field& field, int p, int count) {
  auto* const to = reinterpret_cast<typename R::real*>(&field(p));
  if (count >= R::k_count)
    store_groups(a, to);
  else
    store_some(a, count, to);
}
template <class Value, class Field>
KOKKOS_FORCEINLINE_FUNCTION void store_field(const Value& a, const Field& field, int p, int count) {
  if constexpr (requires { a.c; })
    store_field(a.c, field, p, count);
  else
    store_field(reinterpret_cast<const Value(&)[1]>(a), field, p, count);
}

/// Prefetches memory that is needed soon.
inline void fetch(const void* from, std::size_t bytes) {
  constexpr std::size_t line = 64;
  for (std::size_t at = 0; at < bytes; at += line)
    __builtin_prefetch(static_cast<const char*>(from) + at, 0, 2);
}
/// The last slot in memory among those round a slot; the slots before it have not prefetched that slot.
template <int Dim, class Neighbours>
int last_around(const Neighbours& neighbours, int slot) {
  return neighbours(slot, Patch<Dim>::neighbours - 1);
}

/// A number that many threads change, on a cache line of its own.
struct alignas(64) SharedCount {
  std::atomic<int> n{0};
};

/// Numbers [first, last) that threads divide among them, `together` at a time. Each thread begins with an
/// equal part, or with the numbers next to an equal part of `some`, which rise, so that a thread keeps the
/// data of the last phase.
struct Shared {
  int first = 0, last = 0, together = 1;
  const int* some = nullptr;
  int some_count = 0;

  int part_begin(int part, int parts) const {
    const auto begin_of_range = [&](int count) {
      return static_cast<int>(static_cast<long>(count) * part / parts);
    };
    if (some_count == 0) return first + begin_of_range(last - first);
    return part == 0 ? first : part == parts ? last : some[begin_of_range(some_count)];
  }
};

/// Calls f(phase, n) once for each n of all[phase]. No thread begins a phase before the last phase is done. A
/// thread begins with its own part, which is the same in every step and so in its cache, from front to back,
/// because the processor prefetches in that direction. Then the thread takes numbers that other threads have
/// not reached. On a machine with other load, no thread waits long for a thread that was suspended.
template <int Phases, class Space, class F>
void for_each_shared(const char* label, const Space& space, const Shared (&all)[Phases], const F& f) {
  using Range = Kokkos::RangePolicy<Space, Kokkos::Schedule<Kokkos::Static>>;
  if (!has_threads(space)) {
    for (int phase = 0; phase < Phases; ++phase)
      for (int n = all[phase].first; n < all[phase].last; ++n) f(phase, n);
  } else {
    const int threads = space.concurrency();
    int phases = Phases;
    while (phases > 1 && all[phases - 1].first == all[phases - 1].last) --phases;
    std::vector<SharedCount> counts(Phases * (threads + 1));
    SharedCount *const taken = counts.data(), *const done = taken + Phases * threads;
    for (int n = 0; n < Phases * threads; ++n) taken[n].n = all[n / threads].part_begin(n % threads, threads);
    Kokkos::parallel_for(label, Range(space, 0, threads), [&](int thread) {
      for (int phase = 0; phase < phases; ++phase) {
        const Shared& of = all[phase];
        int mine = 0;
        for (int k = 0; k < threads; ++k) {
          const int whose = (thread + k) % threads, end = of.part_begin(whose + 1, threads);
          auto& next = taken[phase * threads + whose].n;
          // Read before it is changed: all threads can read a line at once that none of them changes any
          // more.
          for (int n; next < end && (n = next.fetch_add(of.together)) < end;)
            for (const int stop = Kokkos::min(n + of.together, end); n < stop; ++n, ++mine) f(phase, n);
        }
        if (phase == phases - 1) return;
        constexpr int k_patience = 1 << 17;  // looks, some 80 us, before the processor is left to others
        auto& ready = done[phase].n;
        if ((ready += mine) == of.last - of.first) ready.notify_all();
        for (int n, looks = 0; (n = ready) < of.last - of.first; ++looks)
          if (looks > k_patience) ready.wait(n);
      }
    });
  }
}

/// The slots that hold points, as places in Bins::active_slots.
template <int Dim, class Space>
Shared slots_held(const Bins<Space>& bins) {
  return {bins.first_active, bins.last_active, 1};
}
/// All slots. Each thread has those next to its part of slots_held; their nodes are little work.
template <int Dim, class Space>
Shared slots_about(const Bins<Space>& bins, int slots) {
  const Shared held = slots_held<Dim>(bins);
  return {0, slots, 2, bins.active_slots.data() + held.first, held.last - held.first};
}

/// Whether the points [from, to) are all of one body.
template <class Points_>
bool of_one_body(const Points_& points, int from, int to) {
  int others = 0;
  if constexpr (requires { points.body; })
    for (int p = from; p < to; ++p) others |= points.body(p) ^ points.body(from);
  return others == 0;
}

/// The properties of the body of point p, in all lanes; without the material and without own masses.
template <class R, class Points_>
KOKKOS_FORCEINLINE_FUNCTION BodyProperties<R> body_of(const Points_& points, int p) {
  const auto in_all_lanes = [](const auto& of) {
    BodyProperties<R> body;
    body.mass = of.mass;
    body.half_length.l = of.half_length.l, body.half_length.inverse = of.half_length.inverse;
    return body;
  };
  if constexpr (requires { points.body; })
    return in_all_lanes(points.bodies(points.body(p)));
  else
    return in_all_lanes(points);
}
/// Properties of the bodies of `count` points from p on, by lane. Not inlined, because it is not needed where
/// all points of a patch are of one body.
template <class R, class Points_>
[[gnu::noinline]] KOKKOS_FUNCTION BodyProperties<R> bodies_of(const Points_& points, int p, int count) {
  BodyProperties<R> body = body_of<R>(points, p);
  if constexpr (requires { points.body; })
    for (int l = 1; l < count; ++l) {
      const auto& of = points.bodies(points.body(p + l));
      body.mass.set(l, of.mass);
      body.half_length.l.set(l, of.half_length.l), body.half_length.inverse.set(l, of.half_length.inverse);
    }
  return body;
}

/// The domains of `count` points from p on, by lane; `bodies` has their properties.
template <ParticleDomain domain, class R, int Dim, class Points_>
KOKKOS_FORCEINLINE_FUNCTION DomainOf<R, Dim, domain> domains_of(const Points_& points, int p, int count,
                                                                const BodyProperties<R>& bodies) {
  if constexpr (domain == ParticleDomain::fixed) {
    return bodies.half_length;
  } else if constexpr (domain == ParticleDomain::ring) {
    RingDomain<R> ring{bodies.half_length, R(0)};
    for (int l = 0; l < R::k_count; ++l)
      ring.axis_x.set(l, axis_of<typename R::real>(points, points.cell(p + Kokkos::min(l, count - 1))));
    return ring;
  } else if (points.has_domain) {
    Vector<R, Dim> length;
    load_field(points.half_length, p, count, length.c);
    return with_inverses<R>(length);
  } else {  // as box_or_ring_of
    HalfLengths<R, Dim> half;
    for (int d = 0; d < Dim; ++d) half[d] = bodies.half_length;
    return half;
  }
}

}  // namespace mpm
