#include "input/courant.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {

double largest_courant(const Config& config) {
  // Of g^2 / S along an axis: with one particle a cell its neighbours add nothing to the nodes of a thin
  // body, and the particle is at the worst place in its cell, 2 / l + 1 / (1 - l).
  constexpr double k_lone_cell = 6;
  // Measured (regression/reliability/courant.py): particles of a cell that dilate apart are stiffer.
  constexpr double k_without_f_bar = 0.94, k_has_f_bar = 0.5;
  const double apart = config.f_bar_share < k_has_f_bar ? k_without_f_bar : 1;
  double largest = k_largest_courant;
  for (const BodyConfig& body : config.bodies) {
    const int n = body.shape.particles_per_cell;
    const double along_axis = n > 1 ? 2.0 * n : k_lone_cell;
    largest = std::min(largest, apart * 2 / std::sqrt(config.dim * along_axis * (1 + config.damping)));
  }
  return largest;
}

double standard_courant(const Config& config) {
  constexpr double k_standard = 0.5, k_reserve = 0.95;
  return std::min(k_standard, k_reserve * largest_courant(config));
}

double step_of(const StepLimits& limits, double courant, const Config& config) {
  if (!std::isfinite(limits.viscous)) return courant * limits.wave;
  const double largest = largest_courant(config), share = courant / largest;
  const double wave = largest * limits.wave, rate = 1 / limits.viscous;
  return 2 * share * share / (rate + std::hypot(rate, 2 * share / wave));
}

}  // namespace mpm
