#pragma once
// Pore pressure and flux of particles in a step, from the values of the nodes there (physics/pore_flow.hpp).

#include "data/core.hpp"
#include "physics/domain.hpp"
#include "physics/pore_flow.hpp"

namespace mpm {

/// Values of the nodes at a particle: divergence of the velocity of the grains and of the flux [1/s], flux
/// [m/s] and its rate [m/s2].
template <int Dim>
struct PoreSample {
  double of_grains = 0, of_flux = 0;
  Vector<double, Dim> flux{}, rate{};
};

/// Sums over the particles of a cell [m3, m3/s]: of the volume, and of the volume times the divergences of
/// grains and flux together, and of the flux alone.
struct PoreSums {
  double volume = 0, strained = 0, drained = 0;
};

template <class Space, class T, int Dim>
struct PoreUpdate {
  Soil<Space, T, Dim> soil;
  decltype(PoreFlow<Space, Dim>::pores) pores;
  decltype(Strays<Space>::alone) alone;
  WaterInPores water;
  double dt;  // s

  KOKKOS_INLINE_FUNCTION bool is_wet(int p) const {
    return pores(soil.material_of(p)).saturated && !is_alone(alone, soil.cell(p));
  }
  KOKKOS_INLINE_FUNCTION double porosity(int p) const {
    return 1 - double(soil.solid_volume(p)) / double(soil.volume(p));
  }
  /// Gives particle p its flux at the end of the step, and its terms to the sums of its cell.
  KOKKOS_INLINE_FUNCTION void add(int p, const PoreSample<Dim>& at, PoreSums& sums) const {
    const double k = permeability_at(pores(soil.material_of(p)), porosity(p)), volume = soil.volume(p);
    const double flip = flux_flip(porosity(p), k, water, dt);
    for (int d = 0; d < Dim; ++d)
      soil.flux(p)[d] =
          static_cast<T>(flip * (double(soil.flux(p)[d]) + dt * at.rate[d]) + (1 - flip) * at.flux[d]);
    sums.volume += volume, sums.drained += volume * at.of_flux;
    sums.strained += volume * (at.of_grains + at.of_flux);
  }
  /// Changes the pressure of the particles [first, last) of a cell. The volume strain of the water, e + div w
  /// dt, is the cell's mean (F-bar with share 1), so that particles of a cell differ in pressure by no noise.
  KOKKOS_INLINE_FUNCTION void press_cell(int first, int last, const PoreSums& sums) const {
    for (int p = first; p < last; ++p)
      if (is_wet(p)) press(p, dt * (sums.strained / sums.volume), dt * (sums.drained / sums.volume));
  }

 private:
  /// Changes the pore pressure of particle p by a volume strain of its water.
  KOKKOS_INLINE_FUNCTION void press(int p, double strain, double drained) const {
    T& pressure = soil.history.column[soil.history.pore](p);
    const T before = pressure;
    const double pressed = double(before) - water.bulk_modulus / porosity(p) * strain;
    const T after = static_cast<T>(pressed > -water.tension ? pressed : -water.tension);
    add_isotropic(soil.stress(p), before - after);
    pressure = after;
    soil.outflow(p) += double(soil.volume(p)) * drained * water_compression(before, water);
  }
};

}  // namespace mpm
