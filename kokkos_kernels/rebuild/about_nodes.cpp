#include "rebuild/about_nodes.hpp"

#include "base/copy.hpp"
#include "base/ensure.hpp"
#include "data/cell_means.hpp"
#include "data/features_of.hpp"
#include "physics/cell_mean.hpp"
#include "physics/materials/any.hpp"
#include "rebuild/shift_particle.hpp"

namespace mpm {

namespace {

/// The particles of a cell of a patch's CellWindow, which are in the patch's bins about the cell.
template <class Space>
struct CellsOfPatches {
  Kokkos::View<int*, typename Space::memory_space> begin;

  /// Calls f(p) for them, in the order of bins and then in that of the particles.
  template <class Places, class F>
  KOKKOS_INLINE_FUNCTION void visit(const Places& place, int slot, int c, const F& f) const {
    for (int corner = 0; corner < 8; ++corner) {
      Coord<3> node = CellWindow::coord(c);
      bool own = true;
      for (int d = 0; d < 3; ++d) {
        node[d] += corner >> d & 1;
        own = own && node[d] >= 0 && node[d] < Patch<3>::edge;
      }
      const int bin = slot * Patch<3>::cells + place_of<3>(node);
      for (int p = own ? begin(bin) : 0; p < (own ? begin(bin + 1) : 0); ++p)
        if (place(p).corner() == corner) f(p);
    }
  }
};

/// Mean stress of a particle [Pa], which a change adds to.
struct MeanStress {
  template <class Soil_>
  KOKKOS_INLINE_FUNCTION static bool has(const Soil_&, int) {
    return true;
  }
  template <class Soil_>
  KOKKOS_INLINE_FUNCTION static auto value(const Soil_& soil, int p) {
    return mean_of(soil.stress(p));
  }
  template <class Soil_, class T>
  KOKKOS_INLINE_FUNCTION static void add(const Soil_& soil, int p, T change) {
    for (int d = 0; d < 3; ++d) soil.stress(p)[d] += change;
  }
};
/// Excess pore pressure [Pa] of a particle that has one.
struct ExcessPressure {
  template <class Soil_>
  KOKKOS_INLINE_FUNCTION static bool has(const Soil_& soil, int p) {
    return material_in(soil.materials(soil.material_of(p))).has_pore_pressure();
  }
  template <class Soil_>
  KOKKOS_INLINE_FUNCTION static auto value(const Soil_& soil, int p) {
    return soil.history.column[soil.history.pore](p);
  }
  template <class Soil_, class T>
  KOKKOS_INLINE_FUNCTION static void add(const Soil_& soil, int p, T change) {
    soil.history.column[soil.history.pore](p) += change;
  }
};

/// Takes from a quantity of each particle that has it the fraction of F-bar of what it differs from the mean
/// over the cell, by volume.
template <class Quantity, class Space, class T>
void average_in_cells(const Core<Space, T, 3>& s, const Quantity&) {
  using Range = Kokkos::RangePolicy<Space>;
  const auto neighbours = s.patches.neighbours;
  const auto place = s.cell_means.place;
  const auto soil = s.soil.points;
  const auto sums = s.cell_means.sums;
  const T fraction = static_cast<T>(s.f_bar.fraction);
  Kokkos::deep_copy(s.space, bytes_of<char>(sums), char(0));
  Kokkos::parallel_for(
      "mpm::sum_in_cells", Range(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
        if (!Quantity::has(soil, p)) return;
        Vector<T, 2>& sum = sums(cell_of_corner(neighbours, soil.cell(p), place(p).corner()));
        Kokkos::atomic_add(&sum[0], soil.volume(p));
        Kokkos::atomic_add(&sum[1], soil.volume(p) * Quantity::value(soil, p));
      });
  Kokkos::parallel_for(
      "mpm::average_in_cells", Range(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
        if (!Quantity::has(soil, p)) return;
        const Vector<T, 2> sum = sums(cell_of_corner(neighbours, soil.cell(p), place(p).corner()));
        const T share = fraction * soil.materials(soil.material_of(p)).f_bar_share;
        Quantity::add(soil, p, share * (CellMean<T>{sum[0], sum[1]}.value() - Quantity::value(soil, p)));
      });
}

}  // namespace

template <class Space, class T, int Dim>
bool wants_bins_about_nodes(const State<Space, T, Dim>& s, double half_length) {
  // Fewer particles lie in so few patches that a launch does many steps, with bins of cells.
  constexpr int k_many = 500'000;
  if constexpr (!is_device<Space> || Dim != 3) return false;
  const auto& soil = s.soil.points;
  return soil.all >= k_many && half_length <= k_longest_about_nodes && !soil.has_domain &&
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
void note_cells([[maybe_unused]] Core<Space, T, Dim>& s) {
  if constexpr (Dim == 3) {
    using Range = Kokkos::RangePolicy<Space>;
    constexpr int bins = Patch<3>::cells, cells = CellWindow::cells;
    const int count = s.soil.points.count, slots = s.patches.slots;
    ensure(s.cell_means.place, count);
    ensure(s.cell_means.first, slots * (cells + 1));
    ensure(s.cell_means.sums, s.patches.node_count());
    const auto place = s.cell_means.place;
    const auto first = s.cell_means.first;
    const auto coordinate = s.soil.points.coordinate;
    const auto bin_of = s.soil.points.cell;
    const CellsOfPatches<Space> of_patches{s.soil.bins.begin};
    Kokkos::parallel_for(
        "mpm::note_corners", Range(s.space, 0, count), KOKKOS_LAMBDA(int p) {
          int corner = 0;
          for (int d = 0; d < 3; ++d) corner |= (coordinate(p)[d] < 0 ? 1 : 0) << d;
          place(p) = CellPlace(bin_of(p) & (bins - 1), corner);
        });
    Kokkos::parallel_for(
        "mpm::count_in_cells", Range(s.space, 0, slots * cells), KOKKOS_LAMBDA(int n) {
          int in_cell = 0;
          of_patches.visit(place, n / cells, n % cells, [&](int) { ++in_cell; });
          first(n / cells * (cells + 1) + n % cells) = in_cell;
        });
    Kokkos::parallel_for(
        "mpm::begin_of_cells", Range(s.space, 0, slots), KOKKOS_LAMBDA(int slot) {
          int sum = 0;
          for (int c = 0; c < cells; ++c) {
            int& of_cell = first(slot * (cells + 1) + c);
            const int in_cell = of_cell;
            of_cell = sum, sum += in_cell;
          }
          first(slot * (cells + 1) + cells) = sum;
        });
    Kokkos::parallel_for(
        "mpm::number_in_cells", Range(s.space, 0, slots * cells), KOKKOS_LAMBDA(int n) {
          int number = first(n / cells * (cells + 1) + n % cells);
          of_patches.visit(place, n / cells, n % cells, [&](int p) { place(p).set_number(number++); });
        });
  }
}

template <class Space, class T, int Dim>
void average_pressure_of_cells([[maybe_unused]] Core<Space, T, Dim>& s) {
  if constexpr (Dim == 3) {
    average_in_cells(s, MeanStress{});
    if (s.soil.points.history.pore >= 0) average_in_cells(s, ExcessPressure{});
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                       \
  template bool wants_bins_about_nodes(const State<Space, T, Dim>&, double); \
  template void bring_to_nodes(Core<Space, T, Dim>&);                        \
  template void note_cells(Core<Space, T, Dim>&);                            \
  template void average_pressure_of_cells(Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
