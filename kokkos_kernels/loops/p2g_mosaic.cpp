#include "loops/particle_to_node.hpp"

namespace mpm {

// Blocks of one colour are at least mosaic_cells - 2 cells apart from each other's reach while no particle
// has moved more than the margin, so their threads share no node and need no atomic additions (the paper's
// Fig. 3).
template <class Source>
void scatter_mosaic(const Interpolation<Source>& it) {
  using T = typename Source::real;
  constexpr int Dim = Source::dim;
  const auto source = it.source;
  const auto grid = it.grid;
  const auto slot_of = it.patches.slot_of;
  const NodePlaces places(it.grid, it.patches);
  const auto begin = it.bins.begin;
  const auto blocks = it.bins.blocks;
  const auto out = it.out;
  const auto control = it.control;
  const int edge = it.mosaic_cells;

  for (int colour = 0; colour < Patch<Dim>::colours; ++colour) {
    const int first = it.bins.block_begin[colour], last = it.bins.block_begin[colour + 1];
    if (first == last) continue;
    Kokkos::parallel_for(
        "mpm::scatter_mosaic", light(Kokkos::RangePolicy<typename Source::Space>(it.space, first, last)),
        KOKKOS_LAMBDA(int b) {
          if (control().paused) return;
          for_each_cell_of_block(grid, blocks(b), edge, [&](const Coord<Dim>& c, int field) {
            const int slot = slot_of(grid.patch_of(c, field));
            if (slot < 0) return;
            const int cell = slot * Patch<Dim>::cells + place_of<Dim>(c);
            for (int p = begin(cell); p < begin(cell + 1); ++p)
              give_to_nodes(source, places, p, [&](int i, int k, T v) { out(i, k) += v; });
          });
        });
  }
}

#define MPM_STRATEGY scatter_mosaic
MPM_FOR_EACH(MPM_INSTANTIATE_STRATEGY)

}  // namespace mpm
