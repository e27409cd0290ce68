#include "check/spring_step.hpp"

#include <cmath>

#include "common/text.hpp"
#include "input/geometry/mass_properties.hpp"

namespace mpm {
namespace {

/// At most the least principal moment of inertia of a rigid body [kg m2], and not less than 4/9 of it: the
/// two others together are at most the trace. 0: it does not turn.
double least_inertia(const Config& config, const RigidConfig& rigid, double mass) {
  const auto of = whole_properties(rigid.shape, config.mesh, config.dim);
  if (!rigid.turns() || !(of || rigid.inertia)) return 0;
  std::array<double, 6> tensor = rigid.inertia ? *rigid.inertia : of->inertia;
  if (!rigid.inertia)
    for (double& component : tensor) component *= mass / of->volume;
  if (config.dim == 2) return rigid.inertia ? tensor[0] : tensor[2];
  const auto& [xx, yy, zz, xy, yz, zx] = tensor;
  const double determinant = zz * (xx * yy - xy * xy) - xx * yz * yz + 2 * xy * yz * zx - yy * zx * zx;
  return determinant / std::pow((xx + yy + zz) / 2, 2);
}

}  // namespace

std::string spring_fault(const Config& config, double dt) {
  constexpr double k_largest = 1;  // of omega dt, and of the rate of a dashpot times dt
  for (const RigidConfig& rigid : config.rigids) {
    if (!rigid.is_sprung() || rigid.absent || rigid.motion != Motion::dynamic) continue;
    const double mass = mass_of(config, rigid);
    const double inertia = least_inertia(config, rigid, mass);
    for (int k = 0; k < 6; ++k) {
      const double resists = k < 3 ? mass : inertia, k_most = resists * std::pow(k_largest / dt, 2);
      const char* const unit = k < 3 ? "N/m" : "N m/rad";
      if (rigid.stiffness[k] > k_most)
        return formatted("mpm: -%s_stiffness: given %g, takes at most %.4g %s with a time step of %g s",
                         rigid.name.c_str(), rigid.stiffness[k], k_most, unit, dt);
      if (rigid.viscosity[k] > resists * k_largest / dt)
        return formatted("mpm: -%s_viscosity: given %g, takes at most %.4g %s with a time step of %g s",
                         rigid.name.c_str(), rigid.viscosity[k], resists * k_largest / dt,
                         k < 3 ? "N s/m" : "N m s/rad", dt);
    }
  }
  return "";
}

}  // namespace mpm
