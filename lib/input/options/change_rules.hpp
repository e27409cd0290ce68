#pragma once
// Changes between a run and its continuation, and from stage to stage. The rule of an option stands where
// the option is read (Option::change).

#include <map>
#include <string>
#include <utility>

#include "mpm/config.hpp"

namespace mpm {

/// Whose an option is: -gravity of the run, -NAME_young of a material NAME, and so on.
enum class Owner { run, material, body, rigid, joint, load, water_region, contact_pair };

/// Where an option may have another value than before.
struct ChangeRule {
  bool restart = false;  // at any restart: where, how long and with what output a run goes on
  bool listed = false;   // at a restart that names it in -restart_change
  bool stage = false;    // from stage to stage

  /// For -help: "at a restart, at a stage"; empty where it may not change.
  std::string text() const;
};
inline constexpr ChangeRule k_at_any_restart{.restart = true}, k_always{.restart = true, .stage = true},
    k_at_stages{.stage = true}, k_by_choice{.listed = true, .stage = true};

/// Rules by owner and key: the name of the option in lower case, without dash, and without the name of its
/// owner and the underscore after that.
using ChangeRules = std::map<std::pair<Owner, std::string>, ChangeRule>;

/// The rule by the whole name of an option of a configuration, without dash.
ChangeRule change_rule(const std::string& name, const Config& config);

}  // namespace mpm
