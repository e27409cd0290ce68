#include "run/changes.hpp"

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <map>

#include "common/checksum.hpp"
#include "common/material_table.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/change_rules.hpp"

namespace mpm {
namespace {

/// Whether two texts are equal, or are lists of equal numbers: 0.1 is .1.
bool same_value(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto one = split(a), other = split(b);
  if (one.size() != other.size()) return false;
  for (std::size_t k = 0; k < one.size(); ++k) {
    const auto x = parse_number(one[k]), y = parse_number(other[k]);
    if (one[k] != other[k] && !(x && y && *x == *y)) return false;
  }
  return true;
}

/// The value of an option; empty if there is none of that name.
std::string value_of(const std::string& name, const std::vector<EffectiveOption>& options) {
  for (const EffectiveOption& option : options)
    if (option.name == name) return option.value;
  return "";
}

/// Note in a checkpoint on a body's file that gives the particles their own values of parameters.
std::string own_parameter_note(const BodyConfig& body, const Config& config) {
  std::string note;
  for (const std::string& key : given_parameters(body, state_variables(config.materials[body.material])))
    note += own_parameter_words(key);
  return note;
}

/// Keeps the contents of a file in place of its name.
void keep_contents(const std::string& option, const std::string& path, const std::string& note,
                   std::vector<EffectiveOption>& options) {
  std::ifstream file(path, std::ios::binary);
  const std::string contents(std::istreambuf_iterator<char>(file), {});
  for (EffectiveOption& kept : options)
    if (kept.name == option)
      kept.value = formatted("a file of %zu bytes with crc32 %08x%s", contents.size(), checksum(0, contents),
                             note.c_str());
}

}  // namespace

std::vector<EffectiveOption> options_to_keep(const std::vector<EffectiveOption>& options,
                                             const Config& config) {
  std::vector<EffectiveOption> kept = options;
  for (const BodyConfig& body : config.bodies) {
    const std::string note = own_parameter_note(body, config), name = "-" + body.name;
    for (const auto& [option, path] : files_of(body.name, body.shape)) {
      const bool listed = body.shape.kind == ShapeKind::particles;
      keep_contents(option, path, listed ? note : "", kept);
    }
    if (!body.field.empty()) keep_contents(name + "_field", body.field, note, kept);
  }
  for (const RigidConfig& rigid : config.rigids)
    for (const auto& [option, path] : files_of(rigid.name, rigid.shape))
      keep_contents(option, path, "", kept);
  for (const auto& [option, path] : table_files(config)) keep_contents(option, path, "", kept);
  return kept;
}

/// Whether the default of an option follows other options, whose own changes are reported.
bool follows_others(const std::string& name) {
  const std::string key = "_f_bar_fraction";  // of a material
  return name.size() > key.size() + 1 && name.compare(name.size() - key.size(), key.size(), key) == 0;
}

/// Whether an option does nothing but set the defaults of others, which are compared themselves.
bool sets_others(const std::string& name) { return name == "-analysis"; }

Comparison compare_options(const Checkpoint& checkpoint, const std::vector<EffectiveOption>& now,
                           const Config& config, const std::string& file,
                           const std::vector<std::string>& allowed) {
  std::map<std::string, const EffectiveOption*> then;
  for (const EffectiveOption& option : checkpoint.options) then[option.name] = &option;
  Comparison found;
  const std::string why = ", which holds in the run of " + file;
  const auto may_change = [&](const std::string& name) {
    return sets_others(name) || change_rule(name.substr(1), config).restart;
  };
  const auto is_allowed = [&](const std::string& name) {
    const auto same = [&](const std::string& word) { return "-" + lower_case(word) == lower_case(name); };
    return std::any_of(allowed.begin(), allowed.end(), same);
  };
  for (const EffectiveOption& option : now) {
    const auto place = then.find(option.name);
    const EffectiveOption* former = place == then.end() ? nullptr : place->second;
    then.erase(option.name);
    if (may_change(option.name) || (former == nullptr && option.standard)) continue;
    if (former != nullptr && same_value(former->value, option.value)) continue;
    if (former != nullptr && former->standard && option.standard && follows_others(option.name)) continue;
    const std::string before = former == nullptr ? "none" : former->value;
    const bool turns_periodic = before == "periodic" || option.value == "periodic";  // a side stays so
    if (is_allowed(option.name) && !turns_periodic)
      found.changes.push_back({option.name, before, option.value});
    else
      found.lines.push_back("mpm: " + option.name + ": " + (option.standard ? "default" : "given") + " \"" +
                            option.value + "\", takes " +
                            (former == nullptr ? "nothing at a restart" : "\"" + former->value + "\"") + why);
  }
  for (const auto& [name, former] : then) {
    if (may_change(name) || former->standard) continue;
    if (is_allowed(name))
      found.changes.push_back({name, former->value, "none"});
    else
      found.lines.push_back("mpm: " + name + ": not given, takes \"" + former->value + "\"" + why);
  }
  return found;
}

void keep_contact(const std::vector<EffectiveOption>& then, Config& config,
                  std::vector<EffectiveOption>& now) {
  for (RigidConfig& rigid : config.rigids) {
    const std::string name = "-" + rigid.name + "_contact", gap = name + "_gap_";
    const auto is_default = [&](const auto& o) { return o.name == name && o.standard; };
    const auto former = std::find_if(then.begin(), then.end(), is_default);
    const auto own = std::find_if(now.begin(), now.end(), is_default);
    if (own == now.end() || former == then.end() || own->value == former->value) continue;
    const bool sites = former->value == "sites",
               gap_given = std::any_of(now.begin(), now.end(),
                                       [&](const auto&o) { return !o.standard && o.name.starts_with(gap); });
    if (sites && (gap_given || config.device_memory_limit)) continue;
    own->value = former->value;
    rigid.contact_at_sites = sites;
    rigid.contact_gap_scaling = rigid.scales_by_gap();
    if (sites) std::erase_if(now, [&](const auto& o) { return o.name.starts_with(gap); });
  }
}

std::vector<OptionChange> changes_between(const std::vector<EffectiveOption>& before,
                                          const std::vector<EffectiveOption>& now) {
  std::map<std::string, std::string> then;
  for (const EffectiveOption& option : before) then[option.name] = option.value;
  std::vector<OptionChange> changes;
  for (const EffectiveOption& option : now) {
    const auto place = then.find(option.name);
    const std::string former = place == then.end() ? "none" : place->second;
    if (!same_value(former, option.value)) changes.push_back({option.name, former, option.value});
    if (place != then.end()) then.erase(place);
  }
  for (const auto& [name, value] : then)
    if (value != "none") changes.push_back({name, value, "none"});
  return changes;
}

void apply_changes(const std::vector<OptionChange>& changes, const Config& config, SavedState& state) {
  for (std::size_t r = 0; r < std::min(config.rigids.size(), state.rigids.size()); ++r) {
    const RigidConfig& rigid = config.rigids[r];
    SavedRigid& row = state.rigids[r];
    const auto changed = [&](std::initializer_list<const char*> keys) {
      return std::any_of(changes.begin(), changes.end(), [&](const OptionChange& change) {
        return std::any_of(keys.begin(), keys.end(), [&](const char* key) {
          return lower_case(change.name) == "-" + lower_case(rigid.name) + key;
        });
      });
    };
    const bool moves = rigid.motion != Motion::fixed;
    if (changed({"_motion", "_velocity", "_velocity_table", "_displacement_table"}))
      set_vector(row, MotionTerms::velocity, moves ? rigid.velocity : Vec3{});
    const bool spins = changed({"_motion", "_angular_velocity", "_angular_velocity_table", "_angle_table"});
    if (!(spins || changed({"_free"})) || row[MotionTerms::turns] == 0) continue;
    for (int k = 0; k < (config.dim == 2 ? 1 : 3); ++k)
      if (spins || !rigid.free[config.dim == 2 ? 5 : 3 + k])
        row[MotionTerms::spin + k] = moves ? rigid.angular_velocity[k] : 0;
    row[MotionTerms::turns] = MotionTerms::k_new_spin;
  }
}

std::vector<char> changed_laws(const std::vector<OptionChange>& changes, const Config& config) {
  std::vector<char> changed(config.bodies.size());
  for (std::size_t b = 0; b < changed.size(); ++b) {
    const BodyConfig& body = config.bodies[b];
    const std::string material = "-" + lower_case(body.name) + "_material",
                      own = "-" + lower_case(config.materials[body.material].name) + "_";
    changed[b] = std::any_of(changes.begin(), changes.end(), [&](const OptionChange& change) {
      const std::string name = lower_case(change.name);
      return name == material || name.starts_with(own);
    });
  }
  return changed;
}

std::string changed_machine(const Checkpoint& then, const Checkpoint& now) {
  std::string text;
  const auto compare = [&](const std::string& what, const std::string& before, const std::string& after) {
    if (!same_value(before, after))
      text += (text.empty() ? "" : ", ") + what + " " + after + " after " + before;
  };
  compare("backend", then.backend, now.backend);
  compare("precision", then.precision, now.precision);
  compare("strategy", then.strategy, now.strategy);
  compare("ranks", std::to_string(then.ranks), std::to_string(now.ranks));
  for (const char* name : {"-rebuild_margin", "-p2g_mosaic_cells", "-p2g_rebuild_interval", "-partition"})
    compare(name, value_of(name, then.options), value_of(name, now.options));
  return text;
}

}  // namespace mpm
