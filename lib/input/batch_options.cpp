// Options that a run whose soil goes through the device's memory in batches cannot have.

#include <array>

#include "base/step_features.hpp"
#include "input/analysis_options.hpp"
#include "input/groups.hpp"

namespace mpm {
namespace {

/// A feature that a Config may have, the option that is refused, and what this option takes.
struct Refusal {
  Feature feature;
  bool on;
  const char* option;
  const char* takes;
};

std::array<Refusal, 9> refusals_of(const Config& config) {
  using F = Feature;
  const VelocityUpdate update = config.velocity_update;
  const char* const limit = "device_memory_limit";
  const char* const update_takes = "-velocity_update flip or pic: no other goes in batches";
  return {{{F::other_strategy, config.p2g.strategy != P2G::tile, limit,
            "-p2g tile or auto: no other goes in batches"},
           {F::splits, config.particle_domain == ParticleDomain::split, limit,
            "-particle_domain fixed or stretch: batches have no room for more particles"},
           {F::xpic, update == VelocityUpdate::xpic, limit, update_takes},
           {F::apic, update == VelocityUpdate::apic, limit, update_takes},
           {F::correction, config.position_correction, limit,
            "-position_correction none: batches are not corrected"},
           {F::energy, config.output.energy, "output_energy",
            "off where -device_memory_limit sends the soil in batches"},
           {F::submerged, config.water.level.has_value(), "water_level",
            "no -device_memory_limit: submerged soil does not go in batches"},
           {F::loads, !config.loads.empty(), "loads",
            "nothing where -device_memory_limit sends the soil in batches"},
           {F::rayleigh, config.rayleigh_mass > 0 || config.rayleigh_stiffness > 0, "rayleigh_ratio",
            "0 where -device_memory_limit sends the soil in batches"}}};
}

}  // namespace

void choose_batches(Config& config) {
  if (config.device_memory_limit && config.p2g.strategy == P2G::automatic) config.p2g.strategy = P2G::tile;
}

void check_batches(OptionReader& in, const Config& config) {
  if (in.listing() || !config.device_memory_limit) return;
  for (const char* name : {"particle_domain", "velocity_update", "position_correction"})
    if (set_by_flow(in, config, name))
      return in.reject("analysis", "penetration where -device_memory_limit sends the soil in batches");
  for (const Refusal& each : refusals_of(config))
    if (each.on && excluding(StepWay::in_batches).has(each.feature)) in.reject(each.option, each.takes);
}

}  // namespace mpm
