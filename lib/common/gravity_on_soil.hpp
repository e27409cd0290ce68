#pragma once
// Soil of which water always carries the same share: less gravity acts on it, and the kernels have no
// water.

#include <algorithm>
#include <cmath>

#include "mpm/config.hpp"

namespace mpm {

/// Whether water carries the same share of the weight of all soil, always: soil of one density, and a level
/// at least a cell above all of the mesh, since a particle reaches half a width beyond its place, and what
/// has left through a free side stays until the next rebuild.
inline bool carries_alike(const Config& config) {
  if (!config.water.level || config.bodies.empty() || water_flows(config)) return false;
  for (const WaterRegionConfig& region : config.water.regions)
    if (region.dry || region.level) return false;
  const Vec3& g = config.gravity;
  const double size = std::hypot(g[0], g[1], g[2]);
  double highest = 0;  // m, against gravity, of the mesh
  for (int d = 0; d < config.dim; ++d)
    highest += std::max(-g[d] / size * config.mesh.lower[d], -g[d] / size * config.mesh.upper[d]);
  const auto density = [&](const BodyConfig& body) { return density_of(config, body); };
  return *config.water.level >= highest + config.mesh.spacing &&
         std::all_of(config.bodies.begin(), config.bodies.end(),
                     [&](const BodyConfig& body) { return density(body) == density(config.bodies[0]); });
}

/// Gravity on the soil [m/s2], less what water carries of all soil alike.
inline Vec3 gravity_on_soil(const Config& config) {
  Vec3 g = config.gravity;
  if (!carries_alike(config)) return g;
  const double share = config.water.density / density_of(config, config.bodies[0]);
  for (double& component : g) component *= 1 - share;
  return g;
}

}  // namespace mpm
