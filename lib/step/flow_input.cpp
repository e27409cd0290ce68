#include "step/flow_input.hpp"

namespace mpm {

FlowInput flow_input(const Config& config) {
  FlowInput in;
  if (!water_flows(config)) return in;
  const WaterConfig& water = config.water;
  in.water = {water.density, water.bulk_modulus, water.density * water.gravity, water.tension};
  for (const MaterialConfig& material : config.materials) {
    const PoreConfig& pores = material.pores;
    in.pores.push_back({material.saturated(), pores.porosity, pores.grain_density,
                        pores.permeability * water.permeability_scale, pores.kozeny});
  }
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const Wall wall = config.mesh.walls[d][side];
      if (is_open(wall))
        in.sides[d][side] = Wall::free;
      else
        in.sides[d][side] = config.mesh.sides[d][side].open_to_water          ? Wall::driven
                            : config.mesh.sides[d][side].numbers.friction > 0 ? Wall::friction
                                                                              : Wall::roller;
    }
  return in;
}

}  // namespace mpm
