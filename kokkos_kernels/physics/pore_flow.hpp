#pragma once
// Water that flows in the pores of saturated soil: the single-point u-w formulation (Zienkiewicz & Shiomi
// 1984). The unknowns are the velocity v of the grains and the Darcy flux w = n (v_water - v). With the pore
// pressure p, the density rho of the mixture and kappa = k / (rho_w g),
//   rho v' + rho_w w' = div(s' - p I) + rho g                 mixture
//   rho_w v' + (rho_w / n) w' = - grad p + rho_w g - w / kappa  water
//   p' = - (K_w / n) (div v + div w)                            mass of compressible water
// Where the soil lies in hydrostatic water (pore_water.hpp), p is in excess of the hydrostatic pressure, and
// the water below the level has no weight.

#include "data/pore_flow.hpp"

namespace mpm {

/// Conductivity k [m/s] of pores at a porosity n.
KOKKOS_INLINE_FUNCTION double permeability_at(const Pores& of, double n) {
  if (!of.kozeny) return of.permeability;
  const double now = n * n * n / ((1 - n) * (1 - n)), n0 = of.porosity,
               start = n0 * n0 * n0 / ((1 - n0) * (1 - n0));
  return of.permeability * (now / start);
}

/// Sums of a node along one axis: m [kg], M_w, M_n + dt D [kg], and the forces on the mixture and on the
/// water [N] at the beginning of the step.
struct FlowNode {
  double mass, water, inertia, force, water_force;
};

/// Accelerations [m/s2]: of the grains, and rate of the flux.
struct FlowRates {
  double grains, flux;
};

/// Solves  m a + M_w w' = F,  M_w a + B w' = r  with B = M_n + dt D and r = f_w - D w: the drag acts with the
/// flux at the end of the step, so that no permeability limits the step. m B > M_w^2, since rho / n > rho_w.
KOKKOS_INLINE_FUNCTION FlowRates solve_flow(const FlowNode& of) {
  const double determinant = of.mass * of.inertia - of.water * of.water;
  return {(of.inertia * of.force - of.water * of.water_force) / determinant,
          (of.mass * of.water_force - of.water * of.force) / determinant};
}

/// Rates where the flux has the rate w' [m/s2], which a side gives it.
KOKKOS_INLINE_FUNCTION FlowRates hold_flux(const FlowNode& of, double rate) {
  return {(of.force - of.water * rate) / of.mass, rate};
}

/// Share of FLIP in the update of a particle's flux: the rest decays as fast as the drag stops it (1 / (1 + n
/// g dt / k)), also where the nodes do not see it.
KOKKOS_INLINE_FUNCTION double flux_flip(double n, double k, const WaterInPores& water, double dt) {
  return 1 / (1 + n * (water.unit_weight / water.density) * dt / k);
}

/// Density of water at a pressure [Pa] over its density without pressure. This law of the density makes the
/// equation of p above the exact balance of the mass of water.
KOKKOS_INLINE_FUNCTION double water_compression(double pressure, const WaterInPores& water) {
  return Kokkos::exp(pressure / water.bulk_modulus);
}

/// Square of the speed of the fast wave [m2/s2] without drag, of a skeleton with the wave modulus M [Pa]
/// (Biot 1956): the larger root of c^4 - t c^2 + D.
KOKKOS_INLINE_FUNCTION double fast_wave_square(double modulus, double n, double solid_density,
                                               double water_density, double bulk_modulus) {
  const double q = bulk_modulus / n;
  const double t = (modulus / (1 - n) + (1 - n) * q) / solid_density + n * q / water_density;
  const double d = modulus * n * q / ((1 - n) * solid_density * water_density);
  return (t + Kokkos::sqrt(Kokkos::fmax(0.0, t * t - 4 * d))) / 2;
}

}  // namespace mpm
