#include "window.hpp"

namespace mpm {
namespace {

/// a += v, by an atomic addition where other threads may add to it at the same time.
template <class Space, class T>
KOKKOS_INLINE_FUNCTION void add_to(T& a, T v) {
  if constexpr (is_device<Space>)
    Kokkos::atomic_add(&a, v);
  else
    a += v;
}

}  // namespace

// A team sums the shares of its patch's particles in scratch memory and adds the window to the nodes. On the
// host patches go colour by colour (windows of one colour share no node); on a device all at once, by atomic
// additions.
template <class Source>
void reduce_by_tile(const Interpolation<Source>& it) {
  using T = typename Source::real;
  using Space = typename Source::Space;
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int Dim = Source::dim, size = Source::size;
  const auto source = it.source;
  const auto around = it.patches.around;
  const auto begin = it.bins.begin;
  const auto by_colour = it.bins.by_colour;
  const auto out = it.out;
  const auto control = it.control;
  constexpr int window = Patch<Dim>::window;
  using Window = Kokkos::View<T*, typename Space::scratch_memory_space, Kokkos::MemoryUnmanaged>;

  constexpr int launches = is_device<Space> ? 1 : Patch<Dim>::colours;
  for (int launch = 0; launch < launches; ++launch) {
    const int first = it.bins.colour_begin[launch];
    const int last = it.bins.colour_begin[is_device<Space> ? Patch<Dim>::colours : launch + 1];
    if (first == last) continue;
    Kokkos::parallel_for(
        "mpm::reduce_by_tile",
        light(Team(it.space, last - first, team_threads<Space>)
                  .set_scratch_size(0, Kokkos::PerTeam(Window::shmem_size(window * size)))),
        KOKKOS_LAMBDA(const typename Team::member_type& team) {
          if (control().paused) return;
          const int slot = by_colour(first + team.league_rank());
          if (source.skips(slot)) return;
          const Window sums(team.team_scratch(0), window * size);
          Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window * size), [&](int n) { sums(n) = 0; });
          team.team_barrier();
          const int from = begin(slot * Patch<Dim>::cells), to = begin((slot + 1) * Patch<Dim>::cells);
          Kokkos::parallel_for(Kokkos::TeamThreadRange(team, from, to), [&](int p) {
            const typename Source::Point q = source.load(p);
            const Coord<Dim> cell = coord_of<Dim>(source.points.cell(p));
            const Vector<T, Dim> x = source.points.coordinate(p);
            with_weights(x, q.half_length, [&](const AxisWeights<T>(&a)[Dim]) {
              for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const Vector<T, Dim>& grad) {
                T* const node = &sums(window_place(cell, a, k) * size);
                const auto offset = [&] { return offset_to(x, a, k); };
                give<Source>(q, w, grad, offset, [&](int value, T v) { add_to<Space>(node[value], v); });
              });
            });
          });
          team.team_barrier();
          Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window), [&](int n) {
            bool touched = false;
            for (int k = 0; k < size; ++k) touched = touched || sums(n * size + k) != 0;
            if (!touched) return;
            const int i = number_at<decltype(around), Dim>(around, slot, window_coord<Dim>(n));
            for (int k = 0; k < size; ++k) add_to<Space>(out(i, k), sums(n * size + k));
          });
        });
  }
}

#define MPM_STRATEGY reduce_by_tile
MPM_FOR_EACH(MPM_INSTANTIATE_STRATEGY)

}  // namespace mpm
