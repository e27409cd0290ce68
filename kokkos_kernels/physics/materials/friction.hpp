#pragma once
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "physics/materials/elasticity.hpp"
#include "physics/materials/parting.hpp"

namespace mpm {

/// The value of a parameter `tension` for which its word `none` is given.
inline constexpr double k_no_tension = -1;

/// Common part of the frictional laws: elasticity; cohesion, friction and dilation; a cohesion that grows
/// linearly with depth below a level and belongs to the particle; a tension cut-off, at the apex of the yield
/// surface where it would be above, at which the soil parts (parting.hpp). Jaumann rate of the Cauchy stress.
template <class T>
struct FrictionalSoil : Elasticity<T, 3> {
  T cohesion, friction_deg, dilation_deg, tension, cohesion_gradient, cohesion_datum, strength_factor;

  /// The rows of the table of parameters that the laws share. `tension_meaning`: of the stress that
  /// `tension` limits.
  template <class Law>
  static constexpr std::array<Parameter<Law>, 8> friction_parameters(const char* tension_meaning) {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    const std::array<Parameter<Law>, 6> own = {
        {{"cohesion", &Law::cohesion, "Pa", "cohesion at and above cohesion_datum", 0, 1e12, required},
         {"friction_deg", &Law::friction_deg, "deg", "angle of friction", 0, 59.99, required},
         {"dilation_deg", &Law::dilation_deg, "deg", "angle of dilation", 0, 59.99, 0},
         {"tension",
          &Law::tension,
          "Pa",
          tension_meaning,
          0,
          1e12,
          k_no_tension,
          nullptr,
          {{{"none", k_no_tension}}}},
         {"cohesion_gradient", &Law::cohesion_gradient, "Pa/m", "growth of the cohesion with depth", 0, 1e12,
          0},
         {"cohesion_datum", &Law::cohesion_datum, "m", "level below which the cohesion grows", -1e9, 1e9,
          0}}};
    return joined(YoungsModulus<T>::template young_rows<Law>(), own);
  }

  enum : int { plastic_strain, cohesion_of_particle, parted, young_of_particle };
  using State = LawState<T, 4>;
  static constexpr std::array<StateVariable, 4> state() {
    return {{{"plastic_strain", "-"},  // accumulated engineering plastic shear strain
             {.name = "cohesion", .unit = "Pa", .changes = false, .output = false, .parameter = "cohesion"},
             parted_variable(),
             YoungsModulus<T>::young_variable()}};
  }
  /// Soil without a limit of tension does not part. Only the last variables may be missing.
  KOKKOS_FUNCTION bool carries(int k) const {
    if (k < parted) return true;
    return this->varies() || (k == parted && (friction_deg > 0 || tension >= 0));
  }
  ParameterFault check() const {
    if (dilation_deg > friction_deg)
      return {"dilation_deg", "an angle in deg that is not above -NAME_friction_deg"};
    if (friction_deg == 0 && cohesion == 0 && cohesion_gradient == 0)
      return {"cohesion", "a cohesion in Pa greater than 0 where -NAME_friction_deg is 0"};
    return this->young_fault();
  }
  std::array<double, 4> initial_state(const ParticleStart& at) const {
    const double depth = at.height < cohesion_datum ? cohesion_datum - at.height : 0.0;
    return {0, at.own[0].value_or(cohesion + cohesion_gradient * depth), 0,
            this->young_at(at.height, at.own[1])};
  }
  /// Undrained shear strength [Pa]: none, since the strength follows the mean stress.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }

 protected:
  /// Angles [rad] of friction and dilation of the strength that is left, and its share of the cohesion. The
  /// apex of the yield surface, c cot(friction), stays where it is.
  struct Reduced {
    double friction, dilation, cohesion_share, apex_over_cohesion;
  };
  Reduced reduced() const {
    const double share = strength_factor > 0 ? 1 / double(strength_factor) : 1.0,
                 whole = radians(friction_deg), phi = share == 1 ? whole : std::atan(share * std::tan(whole)),
                 psi = radians(dilation_deg);
    return {phi, psi < phi ? psi : phi, share, whole > 0 ? 1 / std::tan(whole) : 0.0};
  }
  static double radians(double degrees) { return degrees * (3.14159265358979323846 / 180); }

  /// Warnings for the log about angles below one degree, which are likely radians, and about a cut-off above
  /// the apex [Pa] of the yield surface; a line each.
  std::string friction_warning(double apex) const {
    std::string lines;
    const auto add = [&lines](const char* form, auto... values) {
      char line[256];
      std::snprintf(line, sizeof line, form, values...);
      if (!lines.empty()) lines += '\n';
      lines += line;
    };
    if (friction_deg > 0 && friction_deg < 1)
      add("-NAME_friction_deg: %g is an angle in degrees; is it given in radians?", double(friction_deg));
    if (dilation_deg > 0 && dilation_deg < 1)
      add("-NAME_dilation_deg: %g is an angle in degrees; is it given in radians?", double(dilation_deg));
    if (tension > apex * (1 + 1e-6))
      add("-NAME_tension: %.6g Pa is above the apex of the yield surface, %.6g Pa at the lowest cohesion; "
          "where "
          "it is, the apex is the limit",
          double(tension), apex);
    return lines;
  }
};

}  // namespace mpm
