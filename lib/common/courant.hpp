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

/// Where domains stretch, a particle of half lengths l_d is stable up to c dt / d = 2 / sqrt(sum of A_d (1 +
/// damping)), A_d = 1 / l_d, or 2 + 8 l_d beyond a quarter of a cell, where neighbours may be too far to add
/// to a node (A = 6 of a lone particle at a half). This number times the sum of A_d is 1 where that is
/// largest_courant: a wave that is faster by its root allows largest_courant.
double rim_scale(const Config& config);

/// The Courant number of a run whose user gives none: 0.5, or 95 % of the largest one if that is less.
double standard_courant(const Config& config);

/// Bounds of the time step: the step at a Courant number of 1, by waves, and the largest one by an explicit
/// viscosity away from the rim of a body (viscous_time_step); infinite where there is none.
struct StepLimits {
  double wave, viscous;  // s
};

/// The largest stable step [s] of waves alone, and of the viscosity alone at the rim of a body too.
StepLimits largest_steps(const StepLimits& limits, const Config& config);

/// Time step [s] of a Courant number. Where soil has an explicit viscosity too, a mode of frequency omega
/// that the viscosity damps at the rate c, dv/dt = -c v, is stable while (omega dt / 2)^2 + c dt / 2 <= 1:
/// the waves take the square of their share of dt, the viscosity its share, and their sum is (courant /
/// largest_courant)^2, as with waves alone.
double step_of(const StepLimits& limits, double courant, const Config& config);

}  // namespace mpm
