#pragma once
// The one table of what may change between a run and its continuation, and from stage to stage.

#include <string>

#include "mpm/config.hpp"

namespace mpm {

/// Whose an option is: -gravity of the run, -NAME_young of a material NAME, and so on.
enum class Owner { run, material, body, rigid, load, water_region };

/// Where an option may have another value than before.
struct ChangeRule {
  bool restart = false;  // at any restart: where, how long and with what output a run goes on
  bool listed = false;   // at a restart that names it in -restart_change
  bool stage = false;    // from stage to stage

  /// For -help: "at a restart, at a stage"; empty where it may not change.
  std::string text() const;
};

/// The rule of an option; `key`: its name without dash, and without the name of its owner and the underscore
/// after that.
ChangeRule change_rule(Owner owner, const std::string& key);
/// The rule by the whole name of an option of a configuration, without dash.
ChangeRule change_rule(const std::string& name, const Config& config);

}  // namespace mpm
