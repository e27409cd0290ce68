#pragma once
// Sums of F-bar over cells where bins are about nodes. A cell's particles are in the bins of its eight nodes,
// so a patch adds what its particles give to its own cells and to those before them.

#include "data/cell_means.hpp"
#include "loops/gpu/node_tile.hpp"
#include "loops/gpu/update_about_nodes.hpp"

namespace mpm {

/// A team sums the volume of the particles of a patch and volume times dilatation rate over the cells, where
/// the kernel UpdateAboutNodes takes the patch. The values of a cell's particles lie side by side on a stage,
/// and a thread adds them.
template <class Space, class T, class Laws>
struct CellDilatations {
  using Update = UpdateAboutNodes<Space, T, Laws, true>;
  using Window = NodeWindow<T>;
  using Pair = typename Window::Pair;
  static constexpr int threads = 128, teams = sizeof(T) == sizeof(float) ? 8 : 6, bins = Patch<3>::cells;
  static constexpr int cells = CellWindow::cells;
  static_assert(cells <= threads);
  /// Particles that a round has room for; most patches take one.
  static constexpr int room = 576;

  Update update;

  static constexpr std::size_t bytes() { return Window::bytes() + room * sizeof(Pair); }

  KOKKOS_INLINE_FUNCTION void operator()(const LargeTeam& team, unsigned char* scratch, int index) const {
    const auto& all = update.all;
    const int paused = all.control().paused, slot = all.slots(all.first + index), rank = team.rank;
    if (paused) return;
    const int begin = all.begin(slot * bins), end = all.begin((slot + 1) * bins);
    Sample next = load(begin + rank, end);
    const Cell cell = cell_at(slot, rank);
    const Window window(scratch);
    Pair* const stage = reinterpret_cast<Pair*>(scratch + Window::bytes());
    const NodeImages<T> images{all.grid, all.origin(slot), all.reach(all.origin(slot))};
    update.template load_window<threads>(team, slot, images, window, nullptr);
    Pair sum{};
    for (int first = 0; first < end - begin; first += room) {
      if (first > 0) next = load(begin + rank, end);
      for (int p = begin + rank; p < end; p += threads) {
        const Sample now = next;
        next = load(p + threads, end);
        const int n = now.place.number() - first;
        if (n >= 0 && n < room) stage[staged(n)] = pair_of(window, now);
      }
      team.barrier();
      const int behind = cell.last - first < room ? cell.last - first : room;
      MPM_ROLLED
      for (int n = cell.first > first ? cell.first - first : 0; n < behind; ++n)
        for (int k = 0; k < 2; ++k) sum.c[k] += stage[staged(n)].c[k];
      if (first + room < end - begin) team.barrier();
    }
    if (cell.last <= cell.first) return;
    Vector<T, 2>& of_cell = update.means.sums(cell.number);
    Kokkos::atomic_add(&of_cell[0], sum.c[0]);
    Kokkos::atomic_add(&of_cell[1], sum.c[1] * all.by.inv_spacing);
  }

 private:
  /// Values of a particle.
  struct Sample {
    Vector<T, 3> x;
    T volume;
    CellPlace place;
    int body;
  };
  /// A cell that the patch's particles may be in: its number, and its particles in the patch's order of them.
  struct Cell {
    int number, first, last;
  };

  /// Place on the stage of value n: where cells have eight particles each, the first particles of eight
  /// neighbouring cells lie in different banks.
  KOKKOS_INLINE_FUNCTION static int staged(int n) { return n ^ (n >> 3 & 7); }

  KOKKOS_INLINE_FUNCTION Sample load(int p, int end) const {
    if (p >= end) return {};
    const auto& all = update.all;
    const auto& soil = all.source.points;
    return {soil.coordinate(p), soil.volume(p), update.means.place(p), all.one_body ? 0 : soil.body(p)};
  }
  KOKKOS_INLINE_FUNCTION Cell cell_at(int slot, int n) const {
    if (n >= cells) return {};
    const auto& all = update.all;
    const int at = slot * (cells + 1) + n;
    const int number =
        number_at<std::decay_t<decltype(all.neighbours)>, 3>(all.neighbours, slot, CellWindow::coord(n));
    return {number, update.means.first(at), update.means.first(at + 1)};
  }
  /// Volume [m3], and volume times dilatation rate times a cell's edge.
  KOKKOS_INLINE_FUNCTION Pair pair_of(const Window& window, const Sample& q) const {
    const HalfLength<T> half = update.all.source.points.bodies(q.body).half_length;
    NearestWeights<T> a[3];
    for (int d = 0; d < 3; ++d) a[d] = nearest_weights(q.x[d], half);
    return {q.volume, q.volume * window.dilatation(Window::lowest_of(q.place.bin()), a)};
  }
};

}  // namespace mpm
