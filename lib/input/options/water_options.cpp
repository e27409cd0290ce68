// -water_*: water at rest.

#include <algorithm>
#include <array>
#include <cmath>

#include "common/text.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr std::size_t k_most_regions = 4;  // k_most_water_regions of the kernels

}  // namespace

void read_water(OptionReader& in, Config& config) {
  const Option level{.name = "water_level",
                     .meaning =
                         "level of water at rest that fills the pores and covers the ground below it: "
                         "height along the last axis, or against gravity where that is inclined",
                     .unit = "m",
                     .range = k_coordinate,
                     .change = k_at_stages};
  in.number(level, config.water.level);
  const bool weightless = config.gravity == Vec3{};
  if (!in.listing() && config.water.level && weightless)
    in.reject("water_level", "a -gravity other than 0, which gives water its pressure");
  if (!in.listing() && config.water.level && in.given("gravity_table"))
    in.reject("water_level", "no -gravity_table: water at rest needs a constant -gravity");
  const bool in_pores = in.listing() || !in.owners_of("water").empty();
  if (config.water.level || in_pores)
    in.number({.name = "water_density", .meaning = "density of water", .unit = "kg/m3", .range = k_density},
              config.water.density);
  else
    in.not_taken("water_density", "there is no -water_level, and no material has -NAME_water");
  read_water_in_pores(in, in_pores, config.water);
}

void read_water_region(OptionReader& in, const Config& config, WaterRegionConfig& region) {
  in.section("Each water region NAME", {"water_regions"});
  const int dim = config.dim;
  const auto errors = in.errors();
  in.vector({.name = region.name + "_lower",
             .meaning = "lower corner of its box",
             .unit = "m",
             .range = k_coordinate,
             .required = true},
            dim, region.lower);
  in.vector({.name = region.name + "_upper",
             .meaning = "upper corner of its box",
             .unit = "m",
             .range = k_coordinate,
             .required = true},
            dim, region.upper);
  for (int d = 0; d < dim && !in.listing() && in.errors() == errors; ++d)
    if (!(region.upper[d] > region.lower[d]))
      return in.reject(region.name + "_upper",
                       "a corner above -" + region.name + "_lower, \"" + text_of(region.lower, dim) + "\"");
  const Option level{.name = region.name + "_water_level",
                     .meaning = "level of the water in the region, or dry; by default that of -water_level",
                     .unit = "m",
                     .range = k_coordinate,
                     .standard = "-water_level",
                     .aside = ", or dry",
                     .change = k_at_stages,
                     .words = {"dry"}};
  if (in.given_text(level.name) == "dry") {
    std::string word;
    region.dry = in.text(level, word);
  } else {
    in.number(level, region.level);
  }
}

void check_water_regions(OptionReader& in, const Config& config) {
  if (in.listing() || config.water.regions.empty()) return;
  if (!config.water.level) return in.not_taken("water_regions", "there is no -water_level");
  if (config.water.regions.size() > k_most_regions)
    in.reject("water_regions", "at most " + std::to_string(k_most_regions) + " regions");
  for (const WaterRegionConfig& region : config.water.regions) {
    if (!region.dry && !region.level) continue;
    for (const BodyConfig& body : config.bodies)
      if (body.k0 && !body.from_before && !body.absent)
        return in.reject(region.name + "_water_level",
                         "no level of its own in a stage that places bodies with -NAME_stress k0, as " +
                             body.name + "; a later stage may give it one");
    for (const RigidConfig& rigid : config.rigids) {
      if (rigid.motion != Motion::dynamic || rigid.absent) continue;
      const Bounds bounds = bounds_of(rigid.shape, config.mesh, config.dim);
      bool meets = true;
      for (int d = 0; d < config.dim; ++d)
        meets = meets && bounds.lower[d] < region.upper[d] && bounds.upper[d] > region.lower[d];
      if (meets)
        return in.reject(rigid.name + "_motion",
                         "fixed or prescribed where the body is in the water region " + region.name +
                             ", which has a level of its own");
    }
  }
}

void check_water_kept(OptionReader& in, const Config& first, const Config& now) {
  if (first.water.level.has_value() != now.water.level.has_value())
    in.reject("water_level", "a level in the first stage too; one below the mesh leaves the ground dry");
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
