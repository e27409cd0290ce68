#pragma once
// Sums of F-bar over cells where bins are about nodes. A cell's particles are in the bins of its eight nodes,
// so a patch adds what its particles give to its own cells and to those before them.

#include "data/cell_means.hpp"
#include "loops/gpu/node_tile.hpp"
#include "loops/gpu/update_about_nodes.hpp"

namespace mpm {

/// A team sums the volume of the particles of a patch and volume times dilatation rate over the cells, where
/// the kernel UpdateAboutNodes takes the patch.
template <class Space, class T, class Laws>
struct CellDilatations {
  using Update = UpdateAboutNodes<Space, T, Laws, true>;
  using Window = NodeWindow<T>;
  using Pair = typename Window::Pair;
  static constexpr int threads = 128, teams = sizeof(T) == sizeof(float) ? 8 : 4, bins = Patch<3>::cells;
  static constexpr int cells = CellWindow::cells;
  /// Particles that a round has room for; the bins of most patches take one.
  static constexpr int room = 576;

  Update update;

  static constexpr std::size_t pairs_at() { return (Window::bytes() + 15) / 16 * 16; }
  static constexpr std::size_t begin_at() { return pairs_at() + room * sizeof(Pair); }
  static constexpr std::size_t corners_at() { return begin_at() + (bins + 1) * sizeof(int); }
  static constexpr std::size_t bytes() { return corners_at() + room; }

  KOKKOS_INLINE_FUNCTION void operator()(const LargeTeam& team, unsigned char* scratch, int index) const {
    const auto& all = update.all;
    const int paused = all.control().paused, slot = all.slots(all.first + index);
    if (paused) return;
    int* const begin = reinterpret_cast<int*>(scratch + begin_at());
    for (int b = team.rank; b <= bins; b += threads) begin[b] = all.begin(slot * bins + b);
    const Window window(scratch);
    const NodeImages<T> images{all.grid, all.origin(slot), all.reach(all.origin(slot))};
    update.template load_window<threads>(team, slot, images, window);
    for (int bin = 0; bin < bins;) {
      const int first = begin[bin], rank = team.rank;
      int last_bin = bins;
      if (begin[bins] - first > room)
        last_bin = bin + team.count(rank >= bin && rank < bins && begin[rank + 1] - first <= room);
      for (int p = first + rank; p < begin[last_bin]; p += threads) put(scratch, window, slot, p, p - first);
      team.barrier();
      for (int c = rank; c < cells; c += threads) give(scratch, begin, slot, c, bin, last_bin);
      if (last_bin < bins) team.barrier();
      bin = last_bin;
    }
  }

 private:
  /// Puts volume, and volume times dilatation rate, of particle p on the stage as number n.
  KOKKOS_INLINE_FUNCTION void put(unsigned char* scratch, const Window& window, int slot, int p,
                                  int n) const {
    const auto& all = update.all;
    const auto& soil = all.source.points;
    const BodyProperties<T> body = soil.bodies(all.one_body ? 0 : soil.body(p));
    const Vector<T, 3> x = soil.coordinate(p);
    NearestWeights<T> a[3];
    for (int d = 0; d < 3; ++d) a[d] = nearest_weights(x[d], body.half_length);
    const T rate = window.dilatation(Window::lowest_of(soil.cell(p) - slot * bins), a) * all.by.inv_spacing,
            volume = soil.volume(p);
    reinterpret_cast<Pair*>(scratch + pairs_at())[n] = {volume, volume * rate};
    scratch[corners_at() + n] = update.means.corner(p);
  }

  /// Adds cell c of those that the patch's particles may be in, from the bins [first_bin, last_bin) of its
  /// nodes.
  KOKKOS_INLINE_FUNCTION void give(const unsigned char* scratch, const int* begin, int slot, int c,
                                   int first_bin, int last_bin) const {
    const Coord<3> cell = CellWindow::coord(c);
    T volume = 0, sum = 0;
    MPM_ROLLED
    for (int corner = 0; corner < 8; ++corner) {
      Coord<3> node = cell;
      bool own = true;
      for (int d = 0; d < 3; ++d) {
        node[d] += corner >> d & 1;
        own = own && node[d] >= 0 && node[d] < Patch<3>::edge;
      }
      const int bin = place_of<3>(node);
      if (!own || bin < first_bin || bin >= last_bin) continue;
      MPM_ROLLED
      for (int n = begin[bin] - begin[first_bin]; n < begin[bin + 1] - begin[first_bin]; ++n) {
        if (scratch[corners_at() + n] != corner) continue;
        const Pair pair = reinterpret_cast<const Pair*>(scratch + pairs_at())[n];
        volume += pair.c[0], sum += pair.c[1];
      }
    }
    if (volume == 0) return;
    const auto& neighbours = update.all.neighbours;
    Vector<T, 2>& of_cell =
        update.means.sums(number_at<std::decay_t<decltype(neighbours)>, 3>(neighbours, slot, cell));
    Kokkos::atomic_add(&of_cell[0], volume);
    Kokkos::atomic_add(&of_cell[1], sum);
  }
};

}  // namespace mpm
