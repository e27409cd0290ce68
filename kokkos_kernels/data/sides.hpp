#pragma once
// Sides of the mesh that act on the soil by more than a mirror (Wall::friction, absorbing, driven). Beyond such
// a side the soil moves as the node on it does; physics/sides.hpp says what the node does.

#include <array>

#include "base/choices.hpp"
#include "base/spaces.hpp"
#include "base/types.hpp"
#include "data/patches.hpp"

namespace mpm {

/// What a node of such a side keeps from step to step: the normal impulse that friction has not used [N s], the
/// normal and the tangential dashpot [kg/s], the static reaction [N], and, since the host last took them, the
/// impulse [N s] and the work [J] of the side on the soil.
template <int Dim>
struct SideTerms {
  static constexpr int stock = 0, dashpot = 1, reaction = 3, impulse = 3 + Dim, work = 3 + 2 * Dim,
                       size = 4 + 2 * Dim;
};

/// A side of the mesh. Its nodes have rows of a table: number `first` + sum of step[d] (at[d] + 1).
template <int Dim>
struct Side {
  Wall kind = Wall::roller;
  bool holds_all = false;        // driven: no component is free
  Vector<double, Dim> velocity;  // m/s, of the present step
  double friction = 0;           // -
  double shear_limit = 0;        // Pa, infinite where there is none
  double unit_mass = 0;          // kg, of a node whose cells are full: its area is that of a cell's face
  double face = 0;               // m2 (m in 2D)
  int first = 0, step[Dim] = {};

  KOKKOS_INLINE_FUNCTION int row(const Coord<Dim>& at) const {
    int row = first;
    for (int d = 0; d < Dim; ++d) row += step[d] * (at[d] + 1);
    return row;
  }
};

/// Rows of the table of a side normal to direction d: of its nodes, and of those beyond the sides around it.
template <class Cells>
int side_rows(const Cells& cells, int dim, int d) {
  int rows = 1;
  for (int k = 0; k < dim; ++k) rows *= k == d ? 1 : cells[k] + 3;
  return rows;
}

template <class Space, int Dim>
struct Sides {
  using Memory = typename Space::memory_space;
  unsigned mask = 0;                 // those that act: bit 2 d + side, as sides_of
  Kokkos::View<Side<Dim>*, Memory> all;  // [2 d + side]; allocated where one acts
  Kokkos::View<double* [SideTerms<Dim>::size], Kokkos::LayoutRight, Memory> nodes;  // by Side::row
  std::array<Side<Dim>, 2 * Dim> host{};  // as the run began
  std::array<double, 2 * Dim> dashpot_factor{};
  unsigned unknown = 0;  // absorbing sides whose dashpots and reactions are not known yet
  std::array<unsigned, 2 * Dim> held{};  // bit k: component k that the side held before it absorbed
  bool in_use() const { return mask != 0; }
};

/// All of them, for kernels.
template <int Dim>
struct ActingSides {
  unsigned mask;
  const Side<Dim>* all;
  double* nodes;
  KOKKOS_INLINE_FUNCTION double* node(int side, const Coord<Dim>& at) const {
    return nodes + all[side].row(at) * SideTerms<Dim>::size;
  }
};
template <class Space, int Dim>
ActingSides<Dim> acting(const Sides<Space, Dim>& s) {
  return {s.mask, s.all.data(), s.nodes.data()};
}

}  // namespace mpm
