#pragma once
// The patch: a square (cube) block of cells that carries storage, order and distribution. Nodal fields exist
// only in active patches: those that hold particles, and the ring around them. An active patch has a slot; a
// node's number is slot * cells + its place in the patch, and so is a cell's (a node is its cell's lower
// corner).

#include "base/patch_edge.hpp"
#include "base/side_kinds.hpp"
#include "base/types.hpp"

namespace mpm {

/// Size of a patch.
template <int Dim>
struct Patch {
  static constexpr int edge = patch_edge(Dim);  // cells
  static constexpr int log_edge = Dim == 2 ? 3 : 2;
  static constexpr int cells = power(edge, Dim);    // 64 in both
  static constexpr int neighbours = power(3, Dim);  // patches round one, itself included
  static constexpr int colours = power(2, Dim);     // of the mosaic's blocks
  static constexpr int window_edge = edge + 3;      // nodes that its particles reach: -1 ... edge + 1
  static constexpr int window = power(window_edge, Dim);
  static_assert(edge == 1 << log_edge);
};

/// Grid coordinates of a cell or node, from the mesh's lower corner.
template <int Dim>
using Coord = Vector<int, Dim>;

/// Place of a cell in its patch (first direction fastest) and back.
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr int place_of(const Coord<Dim>& c) {
  int place = 0;
  for (int d = Dim - 1; d >= 0; --d)
    place = (place << Patch<Dim>::log_edge) + (c[d] & (Patch<Dim>::edge - 1));
  return place;
}
template <int Dim>
KOKKOS_INLINE_FUNCTION constexpr Coord<Dim> coord_of(int place) {
  Coord<Dim> c{};
  for (int d = 0; d < Dim; ++d) c[d] = (place >> (d * Patch<Dim>::log_edge)) & (Patch<Dim>::edge - 1);
  return c;
}

/// The background mesh as kernels see it. One ring of patches lies outside the mesh on every side, for the
/// nodes that a particle at a wall reaches. Each velocity field has a whole grid of patches of its own,
/// numbered behind those of the field before it, so that bodies of two fields share no node.
template <class T, int Dim>
struct Grid {
  T spacing, inv_spacing;  // m, 1/m
  Coord<Dim> cells;        // of the mesh
  Coord<Dim> patches;      // of a velocity field, with the ring outside
  int fields = 1;          // velocity fields
  Wall wall[Dim][2];       // lower and upper side of each direction
  /// Cells after which the mesh repeats itself along a direction with periodic sides: all of them, a multiple
  /// of Patch::edge, so that a patch at one side is the neighbour of that at the other. Else 0.
  Coord<Dim> period{};

  /// Coordinate d of a node [m from the mesh's lower corner], of one beyond the mesh that of the nearest
  /// within: bodies go on beyond the mesh. exact: the spacing in double precision [m].
  KOKKOS_INLINE_FUNCTION double coordinate_within(int d, int node, double exact) const {
    return Kokkos::max(0, Kokkos::min(node, cells[d])) * exact;
  }
  /// The cell (node, patch) within the mesh that is one at `at` along d, of those at most a period beyond the
  /// mesh; where the direction is not periodic: `at`.
  KOKKOS_INLINE_FUNCTION int in_period(int d, int at) const {
    return at < 0 ? at + period[d] : at >= cells[d] ? at - period[d] : at;
  }
  /// The shortest of the ways [cells] along d that lead as one of them does, round the period.
  template <class Way>
  KOKKOS_INLINE_FUNCTION Way shortest(int d, Way way) const {
    if (2 * way > period[d]) return way - period[d];
    return 2 * way < -period[d] ? way + period[d] : way;
  }
  KOKKOS_INLINE_FUNCTION bool is_periodic() const {
    bool is = false;
    for (int d = 0; d < Dim; ++d) is |= period[d] > 0;
    return is;
  }
  KOKKOS_INLINE_FUNCTION bool holds(const Coord<Dim>& cell) const {
    for (int d = 0; d < Dim; ++d)
      if (cell[d] < 0 || cell[d] >= cells[d]) return false;
    return true;
  }
  /// Number of the patch of a cell in the whole grid of patches, the ring outside included.
  KOKKOS_INLINE_FUNCTION long patch_of(const Coord<Dim>& cell, int field = 0) const {
    long n = field;
    for (int d = Dim - 1; d >= 0; --d) n = n * patches[d] + (cell[d] >> Patch<Dim>::log_edge) + 1;
    return n;
  }
  /// Velocity field of a patch by its number.
  KOKKOS_INLINE_FUNCTION int field_of(long patch) const {
    return fields == 1 ? 0 : static_cast<int>(patch / patches_of_field());
  }
  /// Lower cell of a patch, the inverse of patch_of.
  KOKKOS_INLINE_FUNCTION Coord<Dim> origin_of(long patch) const {
    Coord<Dim> c{};
    for (int d = 0; d < Dim; ++d) {
      c[d] = (static_cast<int>(patch % patches[d]) - 1) * Patch<Dim>::edge;
      patch /= patches[d];
    }
    return c;
  }
  /// Address of a cell in the whole grid: patch_of * Patch::cells + place_of. Orders cells as the particles
  /// are.
  KOKKOS_INLINE_FUNCTION long address_of(const Coord<Dim>& cell, int field = 0) const {
    return patch_of(cell, field) * Patch<Dim>::cells + place_of<Dim>(cell);
  }
  /// Patches of one velocity field.
  KOKKOS_INLINE_FUNCTION long patches_of_field() const {
    long n = 1;
    for (int d = 0; d < Dim; ++d) n *= patches[d];
    return n;
  }
  /// Patches of all fields.
  KOKKOS_INLINE_FUNCTION long patch_count() const { return fields * patches_of_field(); }
};

/// The patch table: which patches are active, where, and what lies around them.
template <class Space, int Dim>
struct Patches {
  using Memory = typename Space::memory_space;
  int slots = 0;
  Coord<Dim> turn{};   // directions as slots count them, the one with the fewest patches first
  bool wraps = false;  // patches at periodic sides are neighbours: the slots round one need not rise
  Kokkos::View<int*, Memory> slot_of;        // by Grid::patch_of; -1 where not active
  Kokkos::View<int*, Memory> number;         // of the patch of a slot, Grid::patch_of
  Kokkos::View<Coord<Dim>*, Memory> origin;  // lower cell of a slot
  Kokkos::View<int * [Patch<Dim>::neighbours], Kokkos::LayoutRight, Memory>
      neighbours;  // slots round a slot, of its field; -1 none

  int node_count() const { return slots * Patch<Dim>::cells; }
};

/// Address in the whole grid, as Grid::address_of, of the node (or cell) with number i. `number`: of
/// Patches.
template <int Dim, class Numbers>
KOKKOS_INLINE_FUNCTION long address_of_node(const Numbers& number, int i) {
  return long(number(i / Patch<Dim>::cells)) * Patch<Dim>::cells + i % Patch<Dim>::cells;
}

/// Number of the node (or cell) at place c of a slot, where c may reach into the patches around it.
template <class Neighbours, int Dim>
KOKKOS_INLINE_FUNCTION int number_at(const Neighbours& neighbours, int slot, const Coord<Dim>& c) {
  int which = 0;
  for (int d = Dim - 1; d >= 0; --d) which = which * 3 + (c[d] >> Patch<Dim>::log_edge) + 1;
  const int s = neighbours(slot, which);
  return s < 0 ? -1 : s * Patch<Dim>::cells + place_of<Dim>(c);
}

/// Coordinates in the patch of a place in the window, from -1 to edge + 1.
template <int Dim>
KOKKOS_INLINE_FUNCTION Coord<Dim> window_coord(int n) {
  Coord<Dim> c{};
  for (int d = 0; d < Dim; ++d, n /= Patch<Dim>::window_edge) c[d] = n % Patch<Dim>::window_edge - 1;
  return c;
}

}  // namespace mpm
