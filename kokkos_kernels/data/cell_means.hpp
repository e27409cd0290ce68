#pragma once
// Sums of F-bar where bins are about nodes (P2GPlan::about_nodes): the particles of a cell are then in the
// bins of its eight nodes, of up to eight patches.

#include <cstdint>

#include "data/patches.hpp"

namespace mpm {

/// Where a particle lies among those of its patch. The particles of a patch are numbered by cells, so that a
/// team adds those of a cell one after the other, and always in the same order.
class CellPlace {
 public:
  CellPlace() = default;
  KOKKOS_INLINE_FUNCTION CellPlace(int bin, int corner) : bits_(bin << k_corner_bits | corner) {}
  KOKKOS_INLINE_FUNCTION int bin() const { return bits_ >> k_corner_bits & (Patch<3>::cells - 1); }
  /// Place of the particle's cell about its node: bit d is set where the cell lies below the node along d.
  KOKKOS_INLINE_FUNCTION int corner() const { return bits_ & ((1 << k_corner_bits) - 1); }
  KOKKOS_INLINE_FUNCTION int number() const { return bits_ >> k_number_at; }
  KOKKOS_INLINE_FUNCTION void set_number(int n) {
    bits_ = static_cast<std::uint32_t>(n) << k_number_at | (bits_ & ((1u << k_number_at) - 1));
  }

 private:
  static constexpr int k_corner_bits = 3, k_number_at = k_corner_bits + 3 * Patch<3>::log_edge;
  std::uint32_t bits_ = 0;
};

/// Sums over the particles that were in a cell at the last rebuild, and which particles these are.
template <class Space, class T>
struct CellMeans {
  using Memory = typename Space::memory_space;
  Kokkos::View<CellPlace*, Memory> place;  // of each particle
  /// Number in its patch of the first particle of each cell of the CellWindow of each slot, and of the one
  /// behind the last.
  Kokkos::View<int*, Memory> first;
  /// By the number of the cell: volume [m3], and volume times dilatation rate [m3/s].
  Kokkos::View<Vector<T, 2>*, Memory> sums;
};

/// Number of the cell of the particle that `corner` is of: its bin has number `bin`.
template <class Neighbours>
KOKKOS_INLINE_FUNCTION int cell_of_corner(const Neighbours& neighbours, int bin, int corner) {
  Coord<3> c = coord_of<3>(bin);
  for (int d = 0; d < 3; ++d) c[d] -= corner >> d & 1;
  return number_at<Neighbours, 3>(neighbours, bin / Patch<3>::cells, c);
}

/// The cells that particles in the bins of a patch may be in: -1 to edge - 1 along each axis.
struct CellWindow {
  static constexpr int edge = Patch<3>::edge + 1, cells = power(edge, 3);
  KOKKOS_INLINE_FUNCTION static Coord<3> coord(int n) {
    return {n % edge - 1, n / edge % edge - 1, n / (edge * edge) - 1};
  }
  /// Number here of the cell of a particle in bin `place` of the patch.
  KOKKOS_INLINE_FUNCTION static int cell_of(int place, int corner) {
    const Coord<3> c = coord_of<3>(place);
    int n = 0;
    for (int d = 2; d >= 0; --d) n = n * edge + c[d] + 1 - (corner >> d & 1);
    return n;
  }
};

}  // namespace mpm
