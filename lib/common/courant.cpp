#include "common/courant.hpp"

#include <algorithm>
#include <cmath>

#include "common/f_bar.hpp"

namespace mpm {
namespace {

/// Share of the viscous limit of soil far from its rim that is stable everywhere. At the rim, as with waves,
/// the rate at which the viscosity damps a node grows with the particles along a cell's edge, for which two
/// are the measure; a flow with dilatation there is damped 4/3 times as fast as shear. Measured on a drop of
/// fluid: stable at 0.7 with two particles along an edge and not at 0.8, at 0.5 and 0.6 with three.
double viscous_share(const Config& config) {
  constexpr double k_dilates = 4.0 / 3;
  const double share = 1 / (k_dilates * (1 + config.damping));
  double most = 2;  // particles along a cell's edge, or as many as one alone counts for
  for (const BodyConfig& body : config.bodies)
    most = std::max(most, body.shape.particles_per_cell > 1 ? double(body.shape.particles_per_cell) : 3.0);
  if (config.particle_domain != ParticleDomain::fixed)
    most = std::max(most, 0.5 / k_least_half_length);  // as short as a domain may become
  return share * 2 / most;
}

/// Share of the limit that is left without F-bar. Measured (regression/reliability/random/run courant):
/// particles of a cell that dilate apart are stiffer.
double share_by_f_bar(const Config& config) {
  constexpr double k_without_f_bar = 0.94, k_has_f_bar = 0.5;
  return f_bar_range(config).least < k_has_f_bar ? k_without_f_bar : 1;
}

}  // namespace

double largest_courant(const Config& config) {
  // Largest g^2 / S along an axis: with one particle a cell its neighbours add nothing to the nodes of a thin
  // body, and the particle is at the worst place in its cell, 2 / l + 1 / (1 - l).
  constexpr double k_lone_cell = 6;
  const double apart = share_by_f_bar(config);
  double largest = k_largest_courant;
  for (const BodyConfig& body : config.bodies) {
    const int n = body.shape.particles_per_cell;
    const double along_axis = n > 1 ? 2.0 * n : k_lone_cell;
    largest = std::min(largest, apart * 2 / std::sqrt(config.dim * along_axis * (1 + config.damping)));
  }
  return largest;
}

double rim_scale(const Config& config) {
  const double half_of = largest_courant(config) / (2 * share_by_f_bar(config));
  return half_of * half_of * (1 + config.damping);
}

double standard_courant(const Config& config) {
  constexpr double k_standard = 0.5, k_reserve = 0.95;
  return std::min(k_standard, k_reserve * largest_courant(config));
}

StepLimits largest_steps(const StepLimits& limits, const Config& config) {
  return {largest_courant(config) * limits.wave, viscous_share(config) * limits.viscous};
}

double step_of(const StepLimits& limits, double courant, const Config& config) {
  const bool damped = config.rayleigh_mass > 0 || config.rayleigh_stiffness > 0;
  if (!std::isfinite(limits.viscous) && !damped) return courant * limits.wave;
  const double largest = largest_courant(config), share = courant / largest;
  const StepLimits stable = largest_steps(limits, config);
  // Damping of the fastest mode, of the frequency w = 2 / stable.wave, adds its rate xi w = beta w2 / 2 +
  // alpha / 2.
  const double rate = 1 / stable.viscous + config.rayleigh_mass / 2 +
                      2 * config.rayleigh_stiffness / (stable.wave * stable.wave);
  return 2 * share * share / (rate + std::hypot(rate, 2 * share / stable.wave));
}

}  // namespace mpm
