#include "rebuild/about_nodes.hpp"

#include "base/copy.hpp"
#include "base/ensure.hpp"
#include "data/features_of.hpp"
#include "physics/cell_mean.hpp"
#include "rebuild/shift_particle.hpp"

namespace mpm {

template <class Space, class T, int Dim>
bool wants_bins_about_nodes(const State<Space, T, Dim>& s, double half_length) {
  // Fewer particles lie in so few patches that a launch does many steps, with bins of cells.
  constexpr int k_many = 500'000;
  if constexpr (!is_device<Space> || Dim != 3) return false;
  const auto& soil = s.soil.points;
  return soil.all >= k_many && half_length <= k_longest_about_nodes && !soil.has_domain && s.light_laws &&
         !(s.f_bar.fraction > 0 && s.f_bar.by_material) && can(StepWay::about_nodes, features_of(s));
}

template <class Space, class T, int Dim>
void bring_to_nodes(Core<Space, T, Dim>& s) {
  const auto grid = s.grid;
  const Coord<Dim> last = last_bins(grid);
  const auto coordinate = s.soil.points.coordinate;
  const auto address = s.soil.address;
  Kokkos::parallel_for(
      "mpm::bring_to_nodes", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.all), KOKKOS_LAMBDA(int p) {
        if (address(p) < 0) return;
        Coord<Dim> cell = cell_of(grid, address(p));
        Vector<T, Dim> x = coordinate(p);
        bool moves = false;
        for (int d = 0; d < Dim; ++d) {
          if (x[d] < T(0.5) || cell[d] + 1 > last[d]) continue;
          x[d] -= 1, ++cell[d], moves = true;
        }
        if (!moves) return;
        coordinate(p) = x;
        address(p) = grid.address_of(cell, grid.field_of(address(p) / Patch<Dim>::cells));
      });
}

template <class Space, class T, int Dim>
void note_cells(Core<Space, T, Dim>& s) {
  const int count = s.soil.points.count;
  ensure(s.cell_means.corner, count);
  ensure(s.cell_means.sums, s.patches.node_count());
  const auto corner = s.cell_means.corner;
  const auto coordinate = s.soil.points.coordinate;
  Kokkos::parallel_for(
      "mpm::note_cells", Kokkos::RangePolicy<Space>(s.space, 0, count), KOKKOS_LAMBDA(int p) {
        int bits = 0;
        for (int d = 0; d < Dim; ++d) bits |= (coordinate(p)[d] < 0 ? 1 : 0) << d;
        corner(p) = static_cast<std::uint8_t>(bits);
      });
}

template <class Space, class T, int Dim>
void average_pressure_of_cells([[maybe_unused]] Core<Space, T, Dim>& s) {
  if constexpr (Dim == 3) {
    using Range = Kokkos::RangePolicy<Space>;
    const auto neighbours = s.patches.neighbours;
    const auto corner = s.cell_means.corner;
    const auto soil = s.soil.points;
    const auto sums = s.cell_means.sums;
    const T fraction = static_cast<T>(s.f_bar.fraction);
    Kokkos::deep_copy(s.space, bytes_of<char>(sums), char(0));
    Kokkos::parallel_for(
        "mpm::sum_pressure_of_cells", Range(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
          Vector<T, 2>& sum = sums(cell_of_corner(neighbours, soil.cell(p), corner(p)));
          Kokkos::atomic_add(&sum[0], soil.volume(p));
          Kokkos::atomic_add(&sum[1], soil.volume(p) * mean_of(soil.stress(p)));
        });
    Kokkos::parallel_for(
        "mpm::average_pressure_of_cells", Range(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
          const Vector<T, 2> sum = sums(cell_of_corner(neighbours, soil.cell(p), corner(p)));
          const T share = fraction * soil.materials(soil.material_of(p)).f_bar_share,
                  change = share * (CellMean<T>{sum[0], sum[1]}.value() - mean_of(soil.stress(p)));
          for (int d = 0; d < 3; ++d) soil.stress(p)[d] += change;
        });
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                       \
  template bool wants_bins_about_nodes(const State<Space, T, Dim>&, double); \
  template void bring_to_nodes(Core<Space, T, Dim>&);                        \
  template void note_cells(Core<Space, T, Dim>&);                            \
  template void average_pressure_of_cells(Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
