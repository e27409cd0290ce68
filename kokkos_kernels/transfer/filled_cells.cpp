#include "transfer/filled_cells.hpp"

#include "base/copy.hpp"

#include <cmath>

namespace mpm {

template <class Space, class T, int Dim>
std::vector<FilledPatch> filled_cells(const ContactCore<Space, T, Dim>& s) {
  using Bits = Kokkos::View<std::uint64_t*, typename Space::memory_space>;
  using Range = Kokkos::RangePolicy<Space>;
  constexpr int cells = Patch<Dim>::cells;
  const int slots = s.patches.slots;
  const Bits soil_bits("mpm::soil_bits", slots), rigid_bits("mpm::rigid_bits", slots);
  const auto soil = s.soil.points;
  const auto neighbours = s.patches.neighbours;
  Kokkos::parallel_for(
      "mpm::cells_with_soil", Range(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
        Coord<Dim> c = coord_of<Dim>(soil.cell(p));
        for (int d = 0; d < Dim; ++d) c[d] += static_cast<int>(Kokkos::floor(soil.coordinate(p)[d]));
        const int n = number_at(neighbours, soil.cell(p) / cells, c);
        if (n >= 0) Kokkos::atomic_or(&soil_bits(n / cells), std::uint64_t(1) << (n % cells));
      });
  for (const auto& set : s.rigid_points) {
    const auto cell = set.points.cell;
    Kokkos::parallel_for(
        "mpm::cells_with_rigid", Range(s.space, 0, set.points.count), KOKKOS_LAMBDA(int p) {
          Kokkos::atomic_or(&rigid_bits(cell(p) / cells), std::uint64_t(1) << (cell(p) % cells));
        });
  }
  s.space.fence("mpm::filled_cells");
  const auto of_soil = mirror_of(soil_bits), of_rigids = mirror_of(rigid_bits);
  const auto number = mirror_of(s.patches.number);
  std::vector<FilledPatch> patches;
  for (int slot = 0; slot < slots; ++slot)
    if ((of_soil(slot) | of_rigids(slot)) != 0)
      patches.push_back({number(slot) % s.grid.patches_of_field(), of_soil(slot), of_rigids(slot)});
  return patches;
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template std::vector<FilledPatch> filled_cells(const ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
