#pragma once
// The gradient of the velocities that particles start with, for APIC.

#include <array>
#include <vector>

namespace mpm {

/// Velocity gradient at each particle of a body, row by row [m/s a cell, dim^2 N], by least squares over the
/// particles in its cell and those around. Exact for a linear field; zero along directions in which the
/// neighbours lie less than a tenth of a cell apart (root mean square).
///   position [cells, dim N]   velocity [m/s, dim N]   period [cells] of a periodic mesh, 0 where it is not
std::vector<double> velocity_gradients(const std::vector<double>& position,
                                       const std::vector<double>& velocity, int dim,
                                       const std::array<int, 3>& period = {});

}  // namespace mpm
