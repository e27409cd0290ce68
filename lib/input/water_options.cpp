// -water_*: water at rest.

#include <algorithm>
#include <array>
#include <cmath>

#include "input/groups.hpp"
#include "input/shapes.hpp"

namespace mpm {

void read_water(OptionReader& in, Config& config) {
  const Option level{.name = "water_level",
                     .meaning =
                         "level of water at rest that fills the pores and covers the ground below it: "
                         "height along the last axis, or against gravity where that is inclined",
                     .unit = "m",
                     .range = k_coordinate};
  in.number(level, config.water.level);
  const bool weightless = config.gravity == Vec3{};
  if (!in.listing() && config.water.level && weightless)
    in.reject("water_level", "a -gravity other than 0, which gives water its pressure");
  if (!in.listing() && config.water.level && in.given("gravity_table"))
    in.reject("water_level", "no -gravity_table: water at rest needs a constant -gravity");
  if (!in.listing() && config.water.level && config.device_memory_limit)
    in.reject("water_level", "no -device_memory_limit: submerged soil does not go in batches");
  if (config.water.level || in.listing())
    in.number({.name = "water_density", .meaning = "its density", .unit = "kg/m3", .range = k_density},
              config.water.density);
  else
    in.not_taken("water_density", "there is no -water_level");
}

std::array<double, 2> heights_of(const Shape& shape, const Config& config) {
  const Bounds bounds = bounds_of(shape, config.mesh, config.dim);
  const double size = std::hypot(config.gravity[0], config.gravity[1], config.gravity[2]);
  std::array<double, 2> heights{};
  for (int d = 0; d < config.dim && size > 0; ++d) {
    const double up = -config.gravity[d] / size;
    heights[0] += std::min(up * bounds.lower[d], up * bounds.upper[d]);
    heights[1] += std::max(up * bounds.lower[d], up * bounds.upper[d]);
  }
  return heights;
}

void check_in_water(OptionReader& in, const Config& config, const RigidConfig& rigid) {
  if (!config.water.level || rigid.motion != Motion::dynamic) return;
  const auto [lowest, highest] = heights_of(rigid.shape, config);
  const double slack = 1e-9 * config.mesh.spacing, level = *config.water.level;
  if (lowest < level - slack && highest > level + slack)
    in.reject(rigid.name + "_motion",
              "fixed or prescribed where -water_level crosses the body: a dynamic one is wholly below it or "
              "above it");
}

}  // namespace mpm
