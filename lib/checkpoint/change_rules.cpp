#include "checkpoint/change_rules.hpp"

#include <algorithm>
#include <vector>

#include "common/text.hpp"

namespace mpm {
namespace {

constexpr ChangeRule k_anew{.restart = true}, k_output{.restart = true, .stage = true},
    k_load{.listed = true, .stage = true}, k_stage{.stage = true};

/// A row of the table. A key that ends in * stands for all that begin so.
struct Row {
  Owner owner;
  const char* key;
  ChangeRule rule;
};

constexpr Row k_rules[] = {
    // Where and how a run computes.
    {Owner::run, "backend", k_anew},
    {Owner::run, "precision", k_anew},
    {Owner::run, "device_memory_limit", k_anew},
    {Owner::run, "p2g", k_anew},
    {Owner::run, "p2g_*", k_anew},
    {Owner::run, "rebuild_margin", k_anew},
    {Owner::run, "partition", k_anew},
    {Owner::run, "rebalance_threshold", k_anew},
    {Owner::run, "halo_*", k_anew},
    {Owner::run, "dry_run", k_anew},
    // How long, and what it writes.
    {Owner::run, "time_end", k_output},
    {Owner::run, "time_max_steps", k_anew},
    {Owner::run, "output_interval", k_output},
    {Owner::run, "output_energy", {}},  // it begins with the run
    {Owner::run, "output_rasters", {}},
    {Owner::run, "raster_origin", k_anew},
    {Owner::run, "raster_interval", k_output},
    {Owner::run, "output_*", k_anew},
    {Owner::run, "history_interval", k_output},
    {Owner::run, "checkpoint_interval", k_output},
    {Owner::run, "restart", k_anew},
    {Owner::run, "restart_change", k_anew},
    {Owner::run, "wall_time_limit", k_anew},
    {Owner::run, "progress", k_anew},
    // Options that end a stage.
    {Owner::run, "end", k_anew},
    {Owner::run, "end_*", k_anew},
    {Owner::run, "unbalanced_ratio", k_anew},
    {Owner::run, "reset", k_anew},
    // The step.
    {Owner::run, "time_step", k_stage},
    {Owner::run, "time_courant", k_stage},
    {Owner::run, "flip_fraction", k_stage},
    {Owner::run, "f_bar_fraction", k_stage},
    {Owner::run, "stray_particles", k_stage},
    {Owner::run, "position_correction", k_stage},
    {Owner::run, "position_correction_rate", k_stage},
    // Options that load the soil and hold it.
    {Owner::run, "gravity", k_load},
    {Owner::run, "gravity_table", k_load},
    {Owner::run, "gravity_table_interpolation", k_load},
    {Owner::run, "damping", k_load},
    {Owner::run, "rayleigh_*", k_load},
    {Owner::run, "strength_factor", k_load},
    {Owner::run, "water_level", k_stage},
    {Owner::water_region, "water_level", k_stage},
    // The soil: its laws and their parameters, except options that only say how it begins.
    {Owner::material, "model", {}},
    {Owner::material, "density", {}},
    {Owner::material, "k0", {}},
    {Owner::material, "ocr", {}},
    {Owner::material, "preconsolidation", {}},
    {Owner::material, "specific_volume", {}},
    {Owner::material, "library", {}},
    {Owner::material, "states", {}},
    {Owner::material, "state_start", {}},
    {Owner::material, "su_ratio", k_stage},
    {Owner::material, "*", k_load},
    {Owner::body, "material", k_load},
    {Owner::body, "cut_out", k_stage},
    {Owner::run, "mesh_xmin*", k_load},
    {Owner::run, "mesh_xmax*", k_load},
    {Owner::run, "mesh_ymin*", k_load},
    {Owner::run, "mesh_ymax*", k_load},
    {Owner::run, "mesh_zmin*", k_load},
    {Owner::run, "mesh_zmax*", k_load},
    {Owner::rigid, "motion", k_load},
    {Owner::rigid, "velocity", k_load},
    {Owner::rigid, "velocity_table", k_load},
    {Owner::rigid, "velocity_table_interpolation", k_load},
    {Owner::rigid, "displacement_table", k_load},
    {Owner::rigid, "displacement_table_interpolation", k_load},
    {Owner::rigid, "force", k_load},
    {Owner::rigid, "force_table", k_load},
    {Owner::rigid, "force_table_interpolation", k_load},
    {Owner::rigid, "density", k_load},
    {Owner::load, "pressure", k_load},
    {Owner::load, "pressure_table", k_load},
    {Owner::load, "pressure_table_interpolation", k_load},
    {Owner::load, "traction", k_load},
    {Owner::load, "traction_table", k_load},
    {Owner::load, "traction_table_interpolation", k_load},
    // Contact.
    {Owner::rigid, "shear_limit", k_load},
    {Owner::rigid, "shear_fraction", k_load},
    {Owner::rigid, "friction", k_load},
    {Owner::rigid, "separation", k_load},
    {Owner::rigid, "contact_gap_*", k_load},
};

bool fits(const std::string& pattern, const std::string& key) {
  if (!pattern.ends_with('*')) return pattern == key;
  return key.starts_with(pattern.substr(0, pattern.size() - 1));
}

template <class Things>
void note_longest(const Things& things, const std::string& name, Owner owner, std::size_t& length,
                  Owner& found) {
  for (const auto& thing : things) {
    const std::string beginning = lower_case(thing.name) + "_";
    if (name.starts_with(beginning) && beginning.size() > length) length = beginning.size(), found = owner;
  }
}

}  // namespace

std::string ChangeRule::text() const {
  std::vector<std::string> when;
  if (restart) when.emplace_back("at a restart");
  if (listed) when.emplace_back("by -restart_change");
  if (stage) when.emplace_back("at a stage");
  return join(when, ", ");
}

ChangeRule change_rule(Owner owner, const std::string& key) {
  const std::string low = lower_case(key);
  for (const Row& row : k_rules)
    if (row.owner == owner && fits(row.key, low)) return row.rule;
  return {};
}

ChangeRule change_rule(const std::string& name, const Config& config) {
  const std::string low = lower_case(name);
  std::size_t length = 0;
  Owner owner = Owner::run;
  note_longest(config.materials, low, Owner::material, length, owner);
  note_longest(config.bodies, low, Owner::body, length, owner);
  note_longest(config.rigids, low, Owner::rigid, length, owner);
  note_longest(config.loads, low, Owner::load, length, owner);
  note_longest(config.water.regions, low, Owner::water_region, length, owner);
  if (config.dim == 2 && low.starts_with("mesh_z")) return {};
  return change_rule(owner, low.substr(length));
}

}  // namespace mpm
