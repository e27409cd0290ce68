#pragma once
// Water that flows in the pores of saturated soil (physics/pore_flow.hpp).

#include "base/side_kinds.hpp"
#include "base/spaces.hpp"
#include "base/types.hpp"
#include "data/particles.hpp"

namespace mpm {

/// Water in pores, the same in the whole run.
struct WaterInPores {
  double density = 1000;        // kg/m3
  double bulk_modulus = 2.2e9;  // Pa
  double unit_weight = 9810;    // N/m3, for which permeabilities are given
  double tension = 100e3;       // Pa, largest that the water takes
};

/// Pores of a material.
struct Pores {
  bool saturated = false;    // with water that flows
  double porosity = 0;       // -, at the start
  double solid_density = 0;  // kg/m3, of the grains
  double permeability = 0;   // m/s, at the porosity of the start
  bool kozeny = false;       // it changes with the porosity n as n^3 / (1 - n)^2
};

/// Porosities that a run may have: beyond them soil is no porous medium.
inline constexpr double k_least_porosity = 0.02, k_most_porosity = 0.98;

/// Whether a side, one of PoreFlow::sides, holds the flux normal to it.
KOKKOS_INLINE_FUNCTION bool holds_flux(Wall side) { return side == Wall::roller || side == Wall::friction; }

/// Flow of water in pores.
template <class Space, int Dim>
struct PoreFlow {
  using Memory = typename Space::memory_space;
  WaterInPores water;
  Kokkos::View<Pores*, Memory> pores;  // by material
  /// Sides of the mesh as the flux meets them. Where water does not pass: a roller, or `friction` where the
  /// force of the water on the side counts, which a mirror would cancel. Else `free` or `driven`. Beyond
  /// `friction` and `driven` the flux goes on as at the side, as velocities do beyond sides that act.
  Wall sides[Dim][2]{};
  Windows<Space> windows;  // of the sums at nodes, in the slots of the soil's

  bool in_use() const { return pores.extent(0) > 0; }
};

/// The mesh as the flux meets its sides.
template <class Space, class T, int Dim>
Grid<T, Dim> grid_of_flow(Grid<T, Dim> grid, const PoreFlow<Space, Dim>& flow) {
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) grid.wall[d][side] = flow.sides[d][side];
  return grid;
}

}  // namespace mpm
