#pragma once
// Where particles are, for what measures them.

#include "data/core.hpp"

namespace mpm {

/// Where particles are, m from the mesh's lower corner. Those that have passed a periodic side since the last
/// rebuild are within the mesh again.
template <class Space, class T, int Dim>
struct Positions {
  Soil<Space, T, Dim> soil;
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  double spacing;     // m
  Coord<Dim> period;  // Grid::period

  KOKKOS_INLINE_FUNCTION double operator()(int p, int d) const {
    const double cells = in_cells(p, d);
    return (cells + (cells < 0 ? period[d] : cells >= period[d] ? -period[d] : 0)) * spacing;
  }
  /// Where it would be had it passed no periodic side.
  KOKKOS_INLINE_FUNCTION double on_its_way(int p, int d) const {
    const double passed = soil.has_periods ? double(soil.periods(p)[d]) * period[d] : 0;
    return (in_cells(p, d) + passed) * spacing;
  }

 private:
  KOKKOS_INLINE_FUNCTION double in_cells(int p, int d) const {
    const int cell = soil.cell(p);
    return double(origin(cell / Patch<Dim>::cells)[d]) + coord_of<Dim>(cell)[d] + soil.coordinate(p)[d];
  }
};

template <class Space, class T, int Dim>
Positions<Space, T, Dim> positions_of(const Core<Space, T, Dim>& s) {
  return {s.soil.points, s.patches.origin, s.spacing, s.grid.period};
}

}  // namespace mpm
