// Lists of the paper's strategies beside the bins: expanded lists of particles by node, and blocks by colour.

#include <limits>
#include <stdexcept>
#include <string>

#include "loops/particle_to_node.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// The half length [cells] that a point has until the next rebuild at most, along any axis.
template <class Source>
KOKKOS_INLINE_FUNCTION typename Source::real most_half_length(const Source& source, int p) {
  if constexpr (requires { source.points.has_domain; })
    if (source.points.has_domain) return typename Source::real(k_most_half_length);
  return source.load(p).half_length[0];
}

/// Calls f(p) for every point that may come to reach node i before it has moved more than the margin.
template <class Source, class Patches_, class Begin, class F>
KOKKOS_INLINE_FUNCTION void for_each_near(const Source& source, const Patches_& patches, const Begin& begin,
                                          typename Source::real margin, int i, F&& f) {
  using T = typename Source::real;
  constexpr int Dim = Source::dim;
  const int slot = i / Patch<Dim>::cells;
  const Coord<Dim> at = coord_of<Dim>(i);
  for (int k = 0; k < power(4, Dim); ++k) {
    Coord<Dim> c = at, from{};  // cells node - 2 ... node + 1 can hold them, as half length + margin <= 1
    for (int d = 0, rest = k; d < Dim; ++d, rest /= 4) c[d] += from[d] = rest % 4 - 2;
    const int cell = number_at<decltype(patches.neighbours), Dim>(patches.neighbours, slot, c);
    if (cell < 0) continue;
    for (int p = begin(cell); p < begin(cell + 1); ++p) {
      const T reach = 1 + most_half_length(source, p) + margin;
      bool near = true;
      for (int d = 0; d < Dim; ++d)
        near = near && Kokkos::fabs(source.points.coordinate(p)[d] + from[d]) <= reach;
      if (near) f(p);
    }
  }
}

template <class Source, class Space>
void build_node_lists(const Space& space, const Source& source, const Patches<Space, Source::dim>& patches,
                      Bins<Space>& bins, double margin_) {
  using Range = Kokkos::RangePolicy<Space>;
  using T = typename Source::real;
  const int nodes = patches.node_count();
  const T margin = static_cast<T>(margin_);
  ensure(bins.list_begin, nodes + 1);
  const auto list_begin = bins.list_begin;
  const auto begin = bins.begin;
  Kokkos::parallel_for(
      "mpm::count_lists", Range(space, 0, nodes), KOKKOS_LAMBDA(int i) {
        int n = 0;
        for_each_near(source, patches, begin, margin, i, [&](int) { ++n; });
        list_begin(i) = n;
      });
  long entries = 0;
  Kokkos::parallel_scan(
      "mpm::begin_of_lists", Range(space, 0, nodes + 1),
      KOKKOS_LAMBDA(int i, long& sum, bool last) {
        const int n = i < nodes ? list_begin(i) : 0;
        if (last) list_begin(i) = static_cast<int>(sum);
        sum += n;
      },
      entries);
  if (entries > std::numeric_limits<int>::max())
    throw std::length_error("-p2g gather: the lists of particles would have " + std::to_string(entries) +
                            " entries, 2147483647 is the most; take another strategy");
  ensure(bins.list, entries);
  const auto list = bins.list;
  Kokkos::parallel_for(
      "mpm::fill_lists", Range(space, 0, nodes), KOKKOS_LAMBDA(int i) {
        int n = list_begin(i);
        for_each_near(source, patches, begin, margin, i, [&](int p) { list(n++) = p; });
      });
}

/// Blocks of the mosaic that hold points, ordered by colour.
template <class Space, class T, int Dim>
void build_blocks(const Space& space, const Grid<T, Dim>& grid, const Patches<Space, Dim>& patches,
                  Bins<Space>& bins, int edge) {
  long count = grid.fields;
  for (int d = 0; d < Dim; ++d) count *= blocks_along(grid, d, edge);
  ensure(bins.blocks, count);
  const auto blocks = bins.blocks;
  const auto begin = bins.begin;
  const auto slot_of = patches.slot_of;
  bins.block_begin[0] = 0;
  for (int colour = 0; colour < Patch<Dim>::colours; ++colour) {
    const int first = bins.block_begin[colour];
    int found = 0;
    Kokkos::parallel_scan(
        "mpm::blocks_by_colour", Kokkos::RangePolicy<Space, Kokkos::IndexType<long>>(space, 0, count),
        KOKKOS_LAMBDA(long b, int& n, bool last) {
          int own = 0;
          long rest = b;
          for (int d = 0; d < Dim; rest /= blocks_along(grid, d, edge), ++d)
            own |= static_cast<int>((rest % blocks_along(grid, d, edge)) & 1) << d;
          if (own != colour) return;
          bool holds = false;
          for_each_cell_of_block(grid, b, edge, [&](const Coord<Dim>& c, int field) {
            const int slot = slot_of(grid.patch_of(c, field));
            if (slot < 0) return;
            const int cell = slot * Patch<Dim>::cells + place_of<Dim>(c);
            holds = holds || begin(cell) < begin(cell + 1);
          });
          if (last && holds) blocks(first + n) = b;
          n += holds;
        },
        found);
    bins.block_begin[colour + 1] = first + found;
  }
}

/// Room for the window of each slot that holds points.
template <class Source, class Space, int Dim>
void build_windows(const Space& space, const Patches<Space, Dim>& patches, Bins<Space>& bins) {
  const int held = bins.last_active;
  ensure(bins.windows.place, patches.slots);
  ensure(bins.windows.sums, window_bytes<Source> * held);
  const auto place = bins.windows.place, active_slots = bins.active_slots;
  Kokkos::deep_copy(space, place, 0);
  Kokkos::parallel_for(
      "mpm::place_windows", Kokkos::RangePolicy<Space>(space, 0, held),
      KOKKOS_LAMBDA(int n) { place(active_slots(n)) = n + 1; });
}

template <class Source, class T, int Dim, class Space>
void build_for(const ContactCore<Space, T, Dim>& s, const Source& source, Bins<Space>& bins) {
  const P2G how = chosen(s.p2g.strategy);
  if (how == P2G::gather) build_node_lists(s.space, source, s.patches, bins, s.p2g.margin + s.p2g.reserve);
  if (how == P2G::mosaic) build_blocks(s.space, s.grid, s.patches, bins, s.p2g.mosaic_cells);
  if (how == P2G::tile && has_windows(s.space)) build_windows<Source>(s.space, s.patches, bins);
}

}  // namespace

template <class Space, class T, int Dim>
void build_lists(ContactCore<Space, T, Dim>& s) {
  build_for(s, SoilSource<Space, T, Dim>{s.soil.points, s.grid.inv_spacing}, s.soil.bins);
  if (s.flow.in_use() && chosen(s.p2g.strategy) == P2G::tile && has_windows(s.space)) {
    s.flow.windows.place = s.soil.bins.windows.place;
    ensure(s.flow.windows.sums, window_bytes<FlowSource<Space, T, Dim>> * s.soil.bins.last_active);
  }
  for (int r = 0; r < static_cast<int>(s.rigid_points.size()) && !s.contact.near.listed; ++r) {
    auto& set = s.rigid_points[r];
    const RigidSource<Space, T, Dim> source{set.points, s.rigids, r, s.patches.origin, s.spacing};
    build_for(s, source, set.bins);
  }
}

#define MPM_INSTANTIATE(Space, T, Dim) template void build_lists(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
