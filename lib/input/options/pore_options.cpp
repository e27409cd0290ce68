// Pores of soil and the water in them: -NAME_water of a material and what goes with it.

#include <algorithm>

#include "common/text.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// Laws whose strength is that of total stress.
constexpr const char* k_total_stress_laws[] = {"tresca", "von_mises", "softening_clay", "j2_hardening"};

bool has_total_strength(const MaterialConfig& material) {
  return std::any_of(std::begin(k_total_stress_laws), std::end(k_total_stress_laws),
                     [&](const char* law) { return material.model == law; });
}

/// Keys beside grain_density, which a law may have too.
constexpr const char* k_pore_keys[] = {"porosity", "permeability", "permeability_law"};

/// Porosity and density of the grains, which give the density.
void read_porosity(OptionReader& in, const std::string& name, PoreConfig& pores) {
  const auto only = in.where(name + "_water", {"undrained", "saturated"});
  in.number({.name = name + "_porosity",
             .meaning = "undrained, saturated: volume of the pores over that of the soil, at the start",
             .unit = "-",
             .range = {.lowest = 0.02, .highest = 0.98, .open_lowest = true, .open_highest = true},
             .required = true},
            pores.porosity);
  in.number(
      {.name = name + "_grain_density",
       .meaning = "undrained, saturated: density of the grains, which with the porosity gives the density",
       .unit = "kg/m3",
       .range = k_density,
       .required = true},
      pores.grain_density);
}

void read_permeability(OptionReader& in, const std::string& name, PoreConfig& pores) {
  const auto only = in.where(name + "_water", {"saturated"});
  in.number(
      {.name = name + "_permeability",
       .meaning = "saturated: hydraulic conductivity at the porosity of the start, under -water_gravity",
       .unit = "m/s",
       .range = {.lowest = 0, .highest = 1e3, .open_lowest = true},
       .required = true,
       .change = k_by_choice},
      pores.permeability);
  in.word({.name = name + "_permeability_law",
           .meaning = "saturated: constant, or kozeny: it changes with the porosity n as n^3 / (1 - n)^2",
           .change = k_by_choice},
          Words<bool>{{"constant", false}, {"kozeny", true}}, pores.kozeny);
}

}  // namespace

void read_pores(OptionReader& in, const Config& config, MaterialConfig& material) {
  const std::string& name = material.name;
  PoreConfig& pores = material.pores;
  in.word({.name = name + "_water",
           .meaning = "water in its pores: off: none but that of -water_level, it drains; undrained: it does "
                      "not flow; saturated: it flows"},
          Words<PoreWater>{{"off", PoreWater::drained},
                           {"undrained", PoreWater::undrained},
                           {"saturated", PoreWater::saturated}},
          pores.water);
  if (pores.water == PoreWater::drained && !in.listing()) {
    for (const char* key : k_pore_keys) in.not_taken(name + "_" + key, "-" + name + "_water is off");
    return;
  }
  const auto errors = in.errors();
  read_porosity(in, name, pores);
  if (in.listing() || pores.water == PoreWater::saturated)
    read_permeability(in, name, pores);
  else
    for (const char* key : {"permeability", "permeability_law"})
      in.not_taken(name + "_" + key, "-" + name + "_water is undrained");
  if (in.listing()) return;
  in.not_taken(name + "_density", "-" + name + "_porosity and -" + name + "_grain_density give it");
  in.not_taken(name + "_pore_stiffness", "-" + name + "_water says what the water does");
  if (in.errors() > errors) return;
  if (!(pores.grain_density > config.water.density))
    in.reject(name + "_grain_density",
              "a density in kg/m3 above that of the water, " + text_of(config.water.density));
  material.density = (1 - pores.porosity) * pores.grain_density + pores.porosity * config.water.density;
  if (pores.water == PoreWater::undrained)
    material.pore_stiffness = config.water.bulk_modulus / pores.porosity;
}

void read_water_in_pores(OptionReader& in, bool some, WaterConfig& water) {
  const auto read = [&](const Option& option, double& value) {
    if (in.listing() || some)
      in.number(option, value);
    else
      in.not_taken(option.name, "no material has -NAME_water undrained or saturated");
  };
  read({.name = "water_bulk_modulus",
        .meaning = "of water in pores; softened to 20 to 100 times the stiffness of the soil times its "
                   "porosity it lengthens the step",
        .unit = "Pa",
        .range = {.lowest = 0, .highest = 1e12, .open_lowest = true}},
       water.bulk_modulus);
  read({.name = "water_gravity",
        .meaning = "gravity under which permeabilities are given, whatever -gravity is",
        .unit = "m/s2",
        .range = {.lowest = 0, .highest = 1e3, .open_lowest = true}},
       water.gravity);
  read({.name = "water_tension",
        .meaning = "largest tension of water that flows, in excess of hydrostatic: it cavitates beyond",
        .unit = "Pa",
        .range = {.lowest = 0, .highest = 1e12}},
       water.tension);
  read({.name = "permeability_scale",
        .meaning = "by which all permeabilities are multiplied: consolidation takes as much less time",
        .unit = "-",
        .range = {.lowest = 1e-6, .highest = 1e9}},
       water.permeability_scale);
}

void read_pore_pressure(OptionReader& in, const Config& config, BodyConfig& body) {
  const Option option{.name = body.name + "_pore_pressure",
                      .meaning =
                          "undrained, saturated: pressure of the water in its pores at the start; where a "
                          "file lists the particles with a pore pressure, theirs counts",
                      .unit = "Pa",
                      .range = k_stress,
                      .standard = in.listing() ? "hydrostatic with -water_level, else 0" : "hydrostatic",
                      .aside = ", or hydrostatic"};
  if (in.listing()) {
    in.number(option, body.pore_pressure);
    return;
  }
  const bool known = body.material >= 0 && body.material < static_cast<int>(config.materials.size());
  if (known && !config.materials[body.material].has_pore_pressure())
    return in.not_taken(option.name,
                        "the pores of material " + config.materials[body.material].name + " drain");
  if (in.given_text(option.name) == "hydrostatic") {
    std::string word;
    in.text(option, word);
    if (!config.water.level) in.reject(option.name, "a number, for there is no -water_level");
  } else {
    in.number(option, body.pore_pressure);
  }
}

void read_permeable(OptionReader& in, RigidConfig& rigid) {
  const std::string option = rigid.name + "_permeable";
  if (!in.listing() && in.owners_of("water").empty())
    return in.not_taken(option, "no body has a material with -NAME_water saturated");
  in.word({.name = option,
           .meaning = "on: water that flows in pores passes the body, and has no pressure at it (hydrostatic "
                      "under -water_level); off: it does not pass",
           .change = k_by_choice},
          Words<bool>{{"off", false}, {"on", true}}, rigid.permeable);
}

void read_side_water(OptionReader& in, const std::string& name, Wall kind, SideConfig& side) {
  const std::string option = name + "_water";
  side.open_to_water = kind == Wall::free;
  if (kind == Wall::periodic && !in.listing()) return in.not_taken(option, "-" + name + " is periodic");
  if (!in.listing() && in.owners_of("water").empty())
    return in.not_taken(option, "no body has a material with -NAME_water saturated");
  const bool found =
      in.word({.name = option,
               .meaning = "water that flows in pores: closed: it does not pass the side; open: "
                          "it passes, and has no pressure there",
               .standard = in.listing() ? "closed, open at a free side" : "",
               .change = k_by_choice},
              Words<bool>{{"closed", false}, {"open", true}}, side.open_to_water);
  if (found && kind == Wall::free && !side.open_to_water)
    in.reject(option, "open where -" + name + " is free: soil that leaves takes its water along");
}

namespace {

/// Rejects the first option that a run in which water flows does not have yet.
void refuse_beside_flow(OptionReader& in, const Config& config) {
  const std::string where = " where the water of a material flows (-NAME_water saturated)";
  if (config.output.energy) in.reject("output_energy", "off" + where);
  if (config.rayleigh_mass > 0 || config.rayleigh_stiffness > 0) in.reject("rayleigh_ratio", "0" + where);
  if (!config.contact_pairs.empty()) in.reject("contact_pairs", "nothing" + where);
  if (config.position_correction) in.reject("position_correction", "none" + where);
  if (config.particle_domain == ParticleDomain::split)
    in.reject("particle_domain", "fixed or stretch" + where);
  for (const WaterRegionConfig& region : config.water.regions)
    if (region.dry || region.level) in.reject(region.name + "_water_level", "no level of its own" + where);
  for (const RigidConfig& rigid : config.rigids) {
    if (rigid.contact_at_sites) in.reject(rigid.name + "_contact", "nodes" + where);
    if (rigid.contact_normal != ContactNormal::surface)
      in.reject(rigid.name + "_contact_normal", "surface" + where);
  }
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const Wall wall = config.mesh.walls[d][side];
      const std::string name = side_option(d, side);
      if (has_dashpots(wall)) in.reject(name, "another kind of side" + where);
    }
}

}  // namespace

void check_pores(OptionReader& in, const Config& config) {
  if (in.listing()) return;
  for (const MaterialConfig& material : config.materials)
    if (material.pores.water != PoreWater::drained && has_total_strength(material))
      in.reject(material.name + "_water",
                "off with the model " + material.model + ", whose strength is that of total stress");
  if (water_flows(config)) return refuse_beside_flow(in, config);
  const std::string none = "no body has a material with -NAME_water saturated";
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side) in.not_taken(side_option(d, side) + "_water", none);
  for (const RigidConfig& rigid : config.rigids) in.not_taken(rigid.name + "_permeable", none);
}

void check_pores_kept(OptionReader& in, const Config& first, const Config& now) {
  if (water_flows(now) && first.water.level != now.water.level)
    in.reject("water_level", "the level of the first stage where the water of a material flows");
  for (std::size_t b = 0; b < std::min(first.bodies.size(), now.bodies.size()); ++b) {
    const auto& was = first.bodies[b].material;
    const auto& is = now.bodies[b].material;
    if (was >= static_cast<int>(first.materials.size()) || is >= static_cast<int>(now.materials.size()))
      return;
    const PoreConfig &before = first.materials[was].pores, &after = now.materials[is].pores;
    if (before.water != after.water || before.porosity != after.porosity ||
        before.grain_density != after.grain_density)
      in.reject(now.bodies[b].name + "_material",
                "a material with the water, porosity and grain density that the body has in the first stage");
  }
}

}  // namespace mpm
