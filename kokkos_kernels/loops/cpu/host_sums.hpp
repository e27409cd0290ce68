#pragma once
// The strategy `tile` on a processor: how the sums of the patches come to the nodes.

#include <algorithm>
#include <array>
#include <cstring>

#include "loops/cpu/host_tile.hpp"

namespace mpm {

/// The places in Patches::neighbours as the slots there rise.
template <int Dim>
std::array<int, Patch<Dim>::neighbours> places_around_in_order(const Coord<Dim>& turn) {
  std::array<int, Patch<Dim>::neighbours> places{};
  for (int n = 0; n < Patch<Dim>::neighbours; ++n)
    for (int k = 0, rest = n; k < Dim; ++k, rest /= 3) places[n] += rest % 3 * power(3, turn[k]);
  return places;
}

/// Sums of the nodes of a patch from the windows of the patches round it, in which these nodes lie too.
template <class Source>
struct NodesOfWindows {
  using T = typename Source::real;
  using Space = typename Source::Space;
  static constexpr int Dim = Source::dim, size = Source::size, edge = Patch<Dim>::edge;
  static constexpr int across = Patch<Dim>::window_edge, window = Patch<Dim>::window;
  using Window = T[size][window];
  using Row = Lanes<T, edge>;

  static constexpr int rows = Patch<Dim>::cells / edge;
  using Rows = Row[rows][size];  // sums of a slot's nodes

  Bins<Space> bins;
  Windows<Space> windows;
  Patches<Space, Dim> patches;
  NodeField<Space, T, size> out;
  bool adds;  // to what is there
  std::array<int, Patch<Dim>::neighbours> in_order = places_around_in_order(patches.turn);

  /// The window of a slot; null if it has none, or no points to sum.
  Window* window_of(int slot) const {
    constexpr int cells = Patch<Dim>::cells;
    if (slot < bins.first_slot || slot >= bins.last_slot || windows.place(slot) == 0) return nullptr;
    if (bins.begin(slot * cells) == bins.begin((slot + 1) * cells)) return nullptr;
    return reinterpret_cast<Window*>(windows.sums.data()) + (windows.place(slot) - 1);
  }

  /// Asks for what a slot takes from the windows.
  void fetch_windows(int slot) const {
    const int last = last_around<Dim>(patches.neighbours, slot);
    if (const Window* const from = last < 0 ? nullptr : window_of(last)) fetch(from, sizeof *from);
  }
  using Places = std::array<int, Patch<Dim>::neighbours>;
  /// The places in Patches::neighbours as those there would give to the nodes of a slot one by one. Round a
  /// period that is as their slots rise, and as the nodes lie in the window of a patch that is several of its
  /// neighbours; `room` is for these.
  const Places& places_around(int slot, Places& room) const {
    if (!patches.wraps) return in_order;
    room = in_order;
    std::sort(room.begin(), room.end(), [&](int a, int b) {
      const int one = patches.neighbours(slot, a), other = patches.neighbours(slot, b);
      return one != other ? one < other : a > b;
    });
    return room;
  }
  /// Loads the sums of the nodes of a slot.
  void load(int slot, Rows& sums) const {
    for (int r = 0; r < rows; ++r) load_groups(&out(slot * Patch<Dim>::cells + r * edge, 0), sums[r]);
  }
  /// To the nodes of a slot.
  void give_nodes(int slot) const {
    Rows sums;
    if (adds) load(slot, sums);
    if (!take(slot, sums) && adds) return;
    for (int r = 0; r < rows; ++r) store_groups(sums[r], &out(slot * Patch<Dim>::cells + r * edge, 0));
  }
  /// To the sums of a slot's nodes, in the order in which the slots round it would give to them one by one.
  /// Where this does not add to what is there, they begin at zero. False if no window holds them.
  bool take(int slot, Rows& sums) const {
    if (!adds)
      for (auto& row : sums)
        for (Row& sum : row) sum = T(0);
    bool some = false;
    Places room;
    for (const int place : places_around(slot, room)) {
      const int other = patches.neighbours(slot, place);
      const Window* const window = other < 0 ? nullptr : window_of(other);
      if (!window) continue;
      some = true;
      const int x = place % 3, y = place / 3 % 3, z = place / 9;
      if (x == 0) add_window<0>(*window, y, z, sums);
      if (x == 1) add_window<1>(*window, y, z, sums);
      if (x == 2) add_window<2>(*window, y, z, sums);
    }
    return some;
  }

  /// Where row n of a patch is in the window of the one before it, itself, or the one behind it: -1 nowhere.
  static constexpr int row_in(int which, int n) {
    const int row = n + 1 + (1 - which) * edge;
    return row < across ? Kokkos::max(row, -1) : -1;
  }
  /// Adds what the window of the patch at place (x, y, z) of those round the nodes holds of them.
  template <int x>
  static void add_window(const Window& window, int y, int z, Rows& sums) {
    for (int r = 0; r < rows; ++r) {
      const int row = row_in(y, r % edge), layer = Dim == 3 ? row_in(z, r / edge) : 0;
      if (row >= 0 && layer >= 0) add_row<x>(window, (row + across * layer) * across, sums[r]);
    }
  }
  /// Adds a row that begins at `from` in the window: its last two nodes, those in the middle, or the first.
  template <int x>
  KOKKOS_FORCEINLINE_FUNCTION static void add_row(const Window& window, int from, Row (&sums)[size]) {
    for (int n = 0; n < size; ++n) {
      const T* const values = window[n] + from;
      Row row = T(0);  // nothing at the nodes that this window does not hold
      if (x == 0)
        for (int l = 0; l < 2; ++l) row.set(l, values[edge + 1 + l]);
      else if (x == 1)
        row = Row::load(values + 1);
      else
        row.set(edge - 1, values[0]);
      sums[n] += row;
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
  bool windowed;

  explicit HostSums(const Interpolation<Source>& it)
      : tile{it.source, it.bins.begin, it.patches.neighbours, it.patches.origin, it.grid, it.out},
        nodes{it.bins, it.windows, it.patches, it.out, it.adds},
        windowed(has_windows(it.space)) {}

  /// The particles of a slot, which holds some.
  void sum(int slot) const {
    if (tile.source.skips(slot)) return;
    if (!windowed) return tile(slot);
    auto& sums = *nodes.window_of(slot);
    std::memset(sums, 0, sizeof sums);
    tile.sum(slot, sums);
  }
  /// Any slot, if `windowed`.
  void give_nodes(int slot) const { nodes.give_nodes(slot); }
};

/// The interpolation on a processor.
template <class Source>
void sum_on_host(const Interpolation<Source>& it) {
  const HostSums sums(it);
  const bool some = it.some_count >= 0;
  const Shared held = slots_held<Source::dim>(it.bins);
  const Shared nodes =
      some ? Shared{0, it.some_count, 1} : slots_about<Source::dim>(it.bins, it.patches.slots);
  const Shared phases[] = {held, sums.windowed ? nodes : Shared{}};
  for_each_shared("mpm::reduce_by_tile", it.space, phases, [&](int phase, int n) {
    if (it.control().paused) return;
    if (phase == 0)
      sums.sum(it.bins.active_slots(n));
    else
      sums.give_nodes(some ? it.some_slots(n) : n);
  });
}

}  // namespace mpm
