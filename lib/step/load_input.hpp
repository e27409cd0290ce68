#pragma once
// Loads and motions that follow tables in time, from the configuration to the kernels.

#include <vector>

#include "mpm/config.hpp"
#include "transfer/upload_loads.hpp"

namespace mpm {

/// The loads of a run; carried[r]: the mass of rigid r whose weight its force includes [kg].
std::vector<LoadInput> load_input(const Config& config, const std::vector<double>& carried);

/// Component d of gravity [m/s2], the pressure and component d of the traction of a load [Pa], and component
/// d of the velocity of a rigid body [m/s] and k of its angular velocity [rad/s], at a time of the tables
/// [s]; present: this velocity without a table.
double gravity_at(const Config& config, int d, double time);
double pressure_at(const LoadConfig& load, double time);
double traction_at(const LoadConfig& load, int d, double time);
double velocity_at(const RigidConfig& rigid, int d, double present, double time);
double spin_at(const RigidConfig& rigid, int k, double present, double time);

}  // namespace mpm
