// -stages, and what each stage owns.

#include <algorithm>

#include "common/text.hpp"
#include "input/options/change_rules.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// The options that a stage alone has.
constexpr const char* k_stage_keys[] = {"end",   "unbalanced_ratio", "end_rigid", "end_displacement",
                                        "reset", "remove",           "place"};

/// The name of an option of the stage in the reader of the stage, and in the help.
std::string name_of(const OptionReader& in, const char* key) {
  return in.listing() ? std::string("STAGE_") + key : key;
}

void read_end_by_displacement(OptionReader& in, const Config& config, StageConfig& stage) {
  const Option rigid{.name = name_of(in, "end_rigid"),
                     .meaning = "displacement: the rigid body whose displacement ends the stage",
                     .required = true,
                     .aside = ", of -rigid_bodies",
                     .change = k_at_any_restart,
                     .names_of = "rigid_bodies"};
  const auto only = in.where(name_of(in, "end"), {"displacement"});
  std::vector<std::string> rigids;
  for (const RigidConfig& each : config.rigids) rigids.push_back(each.name);
  if (rigids.empty() && !in.listing())
    in.reject(name_of(in, "end"), "time or equilibrium where there is no rigid body");
  else
    in.word(rigid, in.listing() ? std::vector<std::string>{"NAME"} : rigids, stage.end_rigid);
  if (!config.rigids.empty() && config.rigids[stage.end_rigid].absent)
    in.reject(rigid.name, "a rigid body that is in the run in this stage");
  in.number({.name = name_of(in, "end_displacement"),
             .meaning = "displacement: its size since the stage began, at which the stage ends",
             .unit = "m",
             .range = k_positive,
             .required = true,
             .change = k_at_any_restart},
            stage.end_displacement);
}

/// Whether one name is the other, or begins the options of the other.
bool begins_alike(const std::string& one, const std::string& other) {
  const std::string a = lower_case(one), b = lower_case(other);
  return a == b || a.starts_with(b + "_") || b.starts_with(a + "_");
}

/// The name of a material, body, rigid, load or probe whose options a stage of this name would take; empty
/// where there is none.
std::string named_so(const OptionReader& in, const std::string& stage) {
  for (const char* list : {"materials", "bodies", "rigid_bodies", "loads", "water_regions", "probes"})
    for (const std::string& name : split(in.given_text(list)))
      if (!name.empty() && begins_alike(name, stage)) return name;
  return "";
}

}  // namespace

std::vector<std::string> read_stage_names(OptionReader& in) {
  std::vector<std::string> stages;
  const Option option{.name = "stages",
                      .meaning =
                          "names of the stages of the run, in order; -STAGE_NAME is the option -NAME in "
                          "the stage, where it may change at a stage",
                      .standard = "none"};
  in.list_of(option, "names, as geostatic,push", stages);
  if (in.listing()) return {};
  OptionReader all;
  InputReport unused;
  all.list(unused);
  list_all(all);
  std::vector<std::string> good;
  for (const std::string& name : stages) {
    if (name.empty()) continue;  // reported
    const std::string fault = name_fault(all, name);
    const bool twice = std::any_of(good.begin(), good.end(),
                                   [&](const std::string& other) { return begins_alike(name, other); });
    const bool begins = std::any_of(all.known().begin(), all.known().end(), [&](const std::string& known) {
      return lower_case(known).starts_with(lower_case(name) + "_");
    });
    const std::string other = named_so(in, name);
    if (begins && fault.empty())
      in.reject(option.name, "names other than " + name + ", which begins other options");
    else if (!other.empty())
      in.reject(option.name,
                "names that neither are those of materials, bodies, rigids, loads and probes nor begin as "
                "they do; " +
                    name + " and " + other + " do not differ so");
    else if (!fault.empty() || twice)
      in.reject(option.name, twice ? "names that differ, of which none begins another: " + name : fault);
    else
      good.push_back(name);
  }
  for (const std::string& former : in.replaced(option.name))  // the deck may still speak of them
    for (const std::string& name : split(former)) {
      const bool kept = std::any_of(good.begin(), good.end(), [&](const std::string& other) {
        return lower_case(other) == lower_case(name);
      });
      if (!kept && name_fault(all, name).empty() && !in.is_left_out(name)) in.leave_out(option.name, name);
    }
  for (const char* key : k_stage_keys)
    if (!good.empty() && in.given(key))
      in.not_taken(key, "it is an option of each stage, as -" + good[0] + "_" + key);
  return good;
}

void read_stage(OptionReader& in, Config& config) {
  StageConfig& stage = config.stage;
  in.section("Each stage STAGE", {"stages"});
  in.word(
      {.name = name_of(in, "end"),
       .meaning = "what ends the stage: its time_end; equilibrium under gravity; or a displacement. Where "
                  "that has not come by its time_end, the run fails",
       .change = k_at_any_restart},
      Words<StageEnd>{{"time", StageEnd::time},
                      {"equilibrium", StageEnd::equilibrium},
                      {"displacement", StageEnd::displacement}},
      stage.end);
  if (const auto only = in.where(name_of(in, "end"), {"equilibrium"});
      stage.end == StageEnd::equilibrium || in.listing())
    in.number({.name = name_of(in, "unbalanced_ratio"),
               .meaning = "equilibrium: mean unbalanced force over mean weight of the nodes, below which the "
                          "soil is in equilibrium",
               .unit = "-",
               .range = {.lowest = 0, .highest = 1, .open_lowest = true},
               .change = k_at_any_restart},
              stage.unbalanced_ratio);
  else
    in.not_taken("unbalanced_ratio", "the stage does not end by equilibrium");
  if (stage.end == StageEnd::equilibrium && config.gravity == Vec3{})
    in.reject(name_of(in, "end"), "time or displacement where there is no gravity");
  if (stage.end == StageEnd::displacement || in.listing())
    read_end_by_displacement(in, config, stage);
  else
    for (const char* key : {"end_rigid", "end_displacement"})
      in.not_taken(key, "the stage does not end by a displacement");
  read_stage_bodies(in, config, stage);
  in.word(
      {.name = name_of(in, "reset"),
       .meaning = "on: at the end of the stage velocities, displacements and plastic strains become zero, "
                  "as after a stage that finds the initial stress",
       .change = k_at_any_restart},
      Words<bool>{{"off", false}, {"on", true}}, stage.reset);
}

void check_stage_changes(OptionReader& in, const Config& config) {
  for (const std::string& name : in.of_stage()) {
    const auto own = [&](const char* key) { return name == key; };
    if (std::any_of(std::begin(k_stage_keys), std::end(k_stage_keys), own)) continue;
    if (in.is_read(name) && !change_rule(name, config).stage)
      in.reject(name,
                "nothing here: this option may not change at a stage; docs/options.md has those that may");
  }
}

}  // namespace mpm
