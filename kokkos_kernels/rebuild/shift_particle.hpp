#pragma once
// Common part of splitting and merging of particles: bounds of their masses and domains, and how a particle
// between locate() and the sort is brought to another place.

#include "data/particles.hpp"
#include "data/patches.hpp"

namespace mpm {

/// Lower bound of a particle's mass and volume over those at the start.
inline constexpr double k_least_piece = 0.125;
/// Masses and numbers in a cell are compared up to this share.
inline constexpr double k_round_off = 1e-3;

/// Half length [cells] beyond which a domain is split. half_length: [cells] of the body's particles at the
/// start.
KOKKOS_INLINE_FUNCTION double split_length(double half_length) {
  constexpr double k_long = 0.4, k_longer = 1.2;
  return Kokkos::fmax(k_long, k_longer * half_length);
}
/// So many particles of a body fill a cell at the start.
template <int Dim>
KOKKOS_INLINE_FUNCTION double filled_by(double half_length) {
  return power(0.5 / half_length, Dim);
}

/// Cell of the mesh of an address.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Coord<Dim> cell_of(const Grid<T, Dim>& grid, long address) {
  const Coord<Dim> from = grid.origin_of(address / Patch<Dim>::cells % grid.patches_of_field()),
                   in = coord_of<Dim>(static_cast<int>(address % Patch<Dim>::cells));
  Coord<Dim> cell;
  for (int d = 0; d < Dim; ++d) cell[d] = from[d] + in[d];
  return cell;
}

/// Where a particle is between locate() and the sort.
template <class T, int Dim>
struct Placed {
  long address;         // Grid::address_of its cell
  Vector<T, Dim> x;     // cells, in the cell
  Coord<Dim> passed{};  // periodic sides, since: upper ones less lower ones
};

/// Brings a particle by `offset` [cells], less than one. False, and nothing is changed, where that is outside
/// the mesh.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool shift(const Grid<T, Dim>& grid, const Vector<double, Dim>& offset,
                                  Placed<T, Dim>& place) {
  Coord<Dim> cell = cell_of(grid, place.address), passed{};
  Vector<T, Dim> at;
  for (int d = 0; d < Dim; ++d) {
    const T moved = static_cast<T>(place.x[d] + offset[d]), whole = Kokkos::floor(moved);
    cell[d] += static_cast<int>(whole);
    at[d] = moved - whole;
    if (at[d] >= 1) at[d] = 0, ++cell[d];  // -tiny + 1 rounds to 1
    const int inside = grid.in_period(d, cell[d]);
    passed[d] = cell[d] > inside ? 1 : cell[d] < inside ? -1 : 0;
    cell[d] = inside;
  }
  if (!grid.holds(cell)) return false;
  const int field = grid.field_of(place.address / Patch<Dim>::cells);
  place = {grid.address_of(cell, field), at, passed};
  return true;
}

/// Puts particle p where shift() has brought it.
template <class Soil_, class Address, class T, int Dim>
KOKKOS_INLINE_FUNCTION void put(const Soil_& soil, const Address& address, int p,
                                const Placed<T, Dim>& place) {
  address(p) = place.address;
  soil.coordinate(p) = place.x;
  for (int d = 0; d < Dim && soil.has_periods; ++d) soil.periods(p)[d] += place.passed[d];
}

}  // namespace mpm
