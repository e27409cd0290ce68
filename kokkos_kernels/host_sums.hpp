#pragma once
// The strategy `tile` on a processor: how the sums of the patches come to the nodes.

#include <cstring>

#include "host_tile.hpp"

namespace mpm {

/// What the nodes of a patch take from the windows of the patches round it, in which they lie too.
template <class Source>
struct NodesOfWindows {
  using T = typename Source::real;
  using Space = typename Source::Space;
  static constexpr int Dim = Source::dim, size = Source::size, edge = Patch<Dim>::edge;
  static constexpr int across = Patch<Dim>::window_edge, window = Patch<Dim>::window;
  using Window = T[size][window];
  using Row = Lanes<T, edge>;

  Bins<Space> bins;
  Windows<Space> windows;
  decltype(Patches<Space, Dim>::around) around;
  NodeField<Space, T, size> out;
  bool adds;  // to what is there

  /// The window of a slot; null if it has none, or no points to sum.
  Window* window_of(int slot) const {
    constexpr int cells = Patch<Dim>::cells;
    if (slot < bins.first_slot || slot >= bins.last_slot || windows.place(slot) == 0) return nullptr;
    if (bins.begin(slot * cells) == bins.begin((slot + 1) * cells)) return nullptr;
    return reinterpret_cast<Window*>(windows.sums.data()) + (windows.place(slot) - 1);
  }

  /// To the nodes of a slot, in the order in which the slots round it would give to them one by one.
  void operator()(int slot) const {
    const Window* round[Patch<Dim>::around];
    bool some = false;
    for (int k = 0; k < Patch<Dim>::around; ++k) {
      round[k] = around(slot, k) < 0 ? nullptr : window_of(around(slot, k));
      some = some || round[k];
    }
    if (!some && adds) return;
    constexpr int layers = Dim == 3 ? edge : 1;
    for (int z = 0; z < layers; ++z)
      for (int y = 0; y < edge; ++y) {
        T* const nodes = &out(slot * Patch<Dim>::cells + (y + edge * z) * edge, 0);
        Row sums[size];
        for (Row& sum : sums) sum = T(0);
        if (adds) load_groups(nodes, sums);
        for (int k = Dim == 3 ? 0 : 1; k < (Dim == 3 ? 3 : 2); ++k)
          for (int j = 0; j < 3; ++j) {
            const int row = row_in(j, y), layer = Dim == 3 ? row_in(k, z) : 0;
            if (row >= 0 && layer >= 0)
              add_row(round + 3 * (j + (Dim == 3 ? 3 * k : 0)), (row + across * layer) * across, sums);
          }
        store_groups(sums, nodes);
      }
  }

  /// Where row y of a patch is in the window of the one before it, itself, or the one behind it: -1 nowhere.
  static constexpr int row_in(int which, int y) {
    const int row = y + 1 + (1 - which) * edge;
    return row < across ? Kokkos::max(row, -1) : -1;
  }

  /// Adds a row of three patches beside one another, from `place` on in their windows.
  KOKKOS_FORCEINLINE_FUNCTION static void add_row(const Window* const* three, int place, Row (&sums)[size]) {
    if (three[0]) {
      for (int n = 0; n < size; ++n) {
        const T* const from = (*three[0])[n] + place + edge + 1;
        Row first = T(0);
        first.set(0, from[0]), first.set(1, from[1]);
        sums[n] += first;
      }
    }
    if (three[1])
      for (int n = 0; n < size; ++n) sums[n] += Row::load((*three[1])[n] + place + 1);
    if (three[2])
      for (int n = 0; n < size; ++n) {
        Row last = T(0);
        last.set(edge - 1, (*three[2])[n][place]);
        sums[n] += last;
      }
  }
};

/// An interpolation, slot by slot. With one thread the patches give to the nodes one after the other. With
/// many each patch has the sums of its window for itself, and once all are there the nodes take from them: to
/// the same bits.
template <class Source>
struct HostSums {
  HostTile<Source> tile;
  NodesOfWindows<Source> nodes;
  bool apart;

  explicit HostSums(const Interpolation<Source>& it)
      : tile{it.source, it.bins.begin, it.patches.around, it.out},
        nodes{it.bins, it.windows, it.patches.around, it.out, it.adds},
        apart(has_windows(it.space)) {}

  /// The particles of a slot, which holds some.
  void sum(int slot) const {
    if (tile.source.skips(slot)) return;
    if (!apart) return tile(slot);
    auto& sums = *nodes.window_of(slot);
    std::memset(sums, 0, sizeof sums);
    tile.sum(slot, sums);
  }
  /// Any slot, if `apart`.
  void give_nodes(int slot) const { nodes(slot); }
};

/// The interpolation on a processor.
template <class Source>
void sum_on_host(const Interpolation<Source>& it) {
  const HostSums sums(it);
  const bool near = it.near_count >= 0;
  const Shared held = slots_held<Source::dim>(it.bins);
  const Shared nodes =
      near ? Shared{0, it.near_count, 1} : slots_about<Source::dim>(it.bins, it.patches.slots);
  const Shared phases[] = {held, sums.apart ? nodes : Shared{}};
  for_each_shared("mpm::reduce_by_tile", it.space, phases, [&](int phase, int n) {
    if (it.control().paused) return;
    if (phase == 0)
      sums.sum(it.bins.by_colour(n));
    else
      sums.give_nodes(near ? it.near_slots(n) : n);
  });
}

}  // namespace mpm
