// Options that a run whose soil goes through the device's memory in batches cannot have.

#include <algorithm>

#include "base/step_features.hpp"
#include "input/options/analysis_options.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// A feature that batches exclude, whether a run has it, the option that is refused, and the text of what
/// this option takes.
struct Refusal {
  Feature feature;
  bool (*on)(const Config&);
  const char* option;
  const char* takes;
};

constexpr const char* k_limit = "device_memory_limit";
constexpr const char* k_updates = "-velocity_update flip or pic: no other goes in batches";

constexpr Refusal k_refusals[] = {
    {Feature::other_strategy, [](const Config& c) { return c.p2g.strategy != P2G::tile; }, k_limit,
     "-p2g tile or auto: no other goes in batches"},
    {Feature::splits, [](const Config& c) { return c.particle_domain == ParticleDomain::split; }, k_limit,
     "-particle_domain fixed or stretch: batches have no room for more particles"},
    {Feature::xpic, [](const Config& c) { return c.velocity_update == VelocityUpdate::xpic; }, k_limit,
     k_updates},
    {Feature::apic, [](const Config& c) { return c.velocity_update == VelocityUpdate::apic; }, k_limit,
     k_updates},
    {Feature::correction, [](const Config& c) { return c.position_correction; }, k_limit,
     "-position_correction none: batches are not corrected"},
    {Feature::energy, [](const Config& c) { return c.output.energy; }, "output_energy",
     "off where -device_memory_limit sends the soil in batches"},
    {Feature::saturated, water_flows, "device_memory_limit",
     "nothing where the water of a material flows (-NAME_water saturated)"},
    {Feature::submerged, [](const Config& c) { return c.water.level.has_value(); }, "water_level",
     "no -device_memory_limit: submerged soil does not go in batches"},
    {Feature::loads, [](const Config& c) { return !c.loads.empty(); }, "loads",
     "nothing where -device_memory_limit sends the soil in batches"},
    {Feature::rayleigh, [](const Config& c) { return c.rayleigh_mass > 0 || c.rayleigh_stiffness > 0; },
     "rayleigh_ratio", "0 where -device_memory_limit sends the soil in batches"},
    {Feature::interfaces, [](const Config& c) { return !c.contact_pairs.empty(); }, "contact_pairs",
     "nothing where -device_memory_limit sends the soil in batches"},
    {Feature::contact_sites,
     [](const Config& c) {
       return std::any_of(c.rigids.begin(), c.rigids.end(),
                          [](const RigidConfig& r) { return r.contact_at_sites; });
     },
     k_limit, "-NAME_contact nodes for every rigid: sites do not go in batches"},
};

/// Features of the table of refusals.
constexpr Features refused() {
  Features all;
  for (const Refusal& each : k_refusals) all.put(each.feature);
  return all;
}
static_assert(refused().bits == excluding(StepWay::in_batches).bits,
              "a row for each feature that batches exclude");

}  // namespace

void choose_batches(Config& config) {
  if (config.device_memory_limit && config.p2g.strategy == P2G::automatic) config.p2g.strategy = P2G::tile;
}

void check_batches(OptionReader& in, const Config& config) {
  for (const Refusal& each : k_refusals) in.restricts(each.option, each.takes);
  if (in.listing() || !config.device_memory_limit) return;
  for (const char* name : {"particle_domain", "velocity_update", "position_correction"})
    if (set_by_flow(in, config, name))
      return in.reject("analysis", "penetration where -device_memory_limit sends the soil in batches");
  for (const Refusal& each : k_refusals)
    if (each.on(config)) in.reject(each.option, each.takes);
}

}  // namespace mpm
