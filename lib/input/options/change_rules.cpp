#include "input/options/change_rules.hpp"

#include <vector>

#include "common/text.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// The rules of all options, as the help lists them.
ChangeRules listed_rules() {
  InputReport report;
  OptionReader in;
  in.list(report);
  list_all(in);
  return in.change_rules();
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

ChangeRule change_rule(const std::string& name, const Config& config) {
  const std::string low = lower_case(name);
  std::size_t length = 0;
  Owner owner = Owner::run;
  note_longest(config.materials, low, Owner::material, length, owner);
  note_longest(config.bodies, low, Owner::body, length, owner);
  note_longest(config.rigids, low, Owner::rigid, length, owner);
  note_longest(config.joints, low, Owner::joint, length, owner);
  note_longest(config.contact_pairs, low, Owner::contact_pair, length, owner);
  note_longest(config.loads, low, Owner::load, length, owner);
  note_longest(config.water.regions, low, Owner::water_region, length, owner);
  if (config.dim == 2 && low.starts_with("mesh_z")) return {};
  static const ChangeRules rules = listed_rules();
  const auto found = rules.find({owner, low.substr(length)});
  return found == rules.end() ? ChangeRule{} : found->second;
}

}  // namespace mpm
