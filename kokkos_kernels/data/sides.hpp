#pragma once
// Sides of the mesh that act on the soil by more than a mirror (Wall::friction to free_field). Beyond
// such a side the soil moves as the node on it does; physics/sides.hpp says what the node does.

#include <array>

#include "base/side_kinds.hpp"
#include "base/spaces.hpp"
#include "base/types.hpp"
#include "data/column_terms.hpp"
#include "data/patches.hpp"
#include "data/side_terms.hpp"

namespace mpm {

/// A side of the mesh. Its nodes have rows of a table: number `first` + sum of step[d] (at[d] + 1).
template <int Dim>
struct Side {
  Wall kind = Wall::roller;
  bool holds_all = false;        // driven: no component is free
  Vector<double, Dim> velocity;  // m/s, of the present step
  SideNumbers numbers;
  double unit_mass = 0;  // kg, of a node whose cells are full: its area is that of a cell's face
  double face = 0;       // m2 (m in 2D)
  int first = 0, step[Dim] = {};
  int first_column = 0;  // free_field: row `first` of the table of columns

  KOKKOS_INLINE_FUNCTION int row(const Coord<Dim>& at) const {
    int row = first;
    for (int d = 0; d < Dim; ++d) row += step[d] * (at[d] + 1);
    return row;
  }
  KOKKOS_INLINE_FUNCTION int column_row(const Coord<Dim>& at) const { return row(at) - first + first_column; }
};

template <class Space, int Dim>
struct Sides {
  using Memory = typename Space::memory_space;
  unsigned mask = 0;                     // those that act: bit 2 d + side, as sides_of
  Kokkos::View<Side<Dim>*, Memory> all;  // [2 d + side]; allocated where one acts
  Kokkos::View<double * [SideTerms<Dim>::size], Kokkos::LayoutRight, Memory> nodes;  // by Side::row
  Kokkos::View<double * [ColumnTerms<Dim>::size], Kokkos::LayoutRight, Memory>
      columns;                               // by Side::column_row; allocated where a side is free_field
  std::array<Side<Dim>, 2 * Dim> host{};     // as the run began
  unsigned unknown = 0;                      // sides whose dashpots and reactions have yet to be computed
  std::array<unsigned, 2 * Dim> held{};      // bit k: component k that the side held before it absorbed
  std::array<unsigned, 2 * Dim> mirrored{};  // bit k: component k that then turned round in a mirror
  bool in_use() const { return mask != 0; }
  bool has_columns() const { return columns.extent(0) > 0; }
};

/// All of them, for kernels.
template <int Dim>
struct ActingSides {
  unsigned mask;
  const Side<Dim>* all;
  double* nodes;
  double* columns;
  KOKKOS_INLINE_FUNCTION double* node(int side, const Coord<Dim>& at) const {
    return nodes + all[side].row(at) * SideTerms<Dim>::size;
  }
  KOKKOS_INLINE_FUNCTION double* column(int side, const Coord<Dim>& at) const {
    return columns + all[side].column_row(at) * ColumnTerms<Dim>::size;
  }
};
template <class Space, int Dim>
ActingSides<Dim> acting(const Sides<Space, Dim>& s) {
  return {s.mask, s.all.data(), s.nodes.data(), s.columns.data()};
}

}  // namespace mpm
