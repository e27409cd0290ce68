#pragma once
// Which Courant numbers are stable.

#include "mpm/config.hpp"

namespace mpm {

/// Largest Courant number c dt / d that is stable, c the fastest wave, d a cell's edge. A node that only the
/// rim of a body reaches moves with omega^2 = c^2 / d^2 times the sum over directions of 1 / l, l = 1 / (2 n)
/// the half length of a particle in cells, n particles along a cell's edge; omega dt <= 2 is stable. So the
/// limit is sqrt(2 / (dim n)), of the body with the most particles, and never above k_largest_courant. With
/// one particle a cell the limit of a lone particle counts, sqrt(2 / (3 dim)). Without F-bar it is 0.94 of
/// that. Local damping adds its share to forces that brake, and so divides the limit by sqrt(1 + damping).
double largest_courant(const Config& config);

/// The Courant number of a run whose user gives none: 0.5, or 95 % of the largest one if that is less.
double standard_courant(const Config& config);

}  // namespace mpm
