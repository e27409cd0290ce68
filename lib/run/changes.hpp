#pragma once
// Changes between a run and its continuation, and whether they are allowed.

#include <string>
#include <vector>

#include "checkpoint/checkpoint.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// The options in force with the checksums of the files that list particles in lieu of these files' names, so
/// that a file may move and may not change, and of which parameters it gives particles own values.
std::vector<EffectiveOption> options_to_keep(const std::vector<EffectiveOption>& options,
                                             const Config& config);

/// An option that has another value than in the checkpoint.
struct OptionChange {
  std::string name, before, after;  // with its dash; "none" where it is not given
};

/// Line for the log on a change.
inline std::string line_of(const OptionChange& c) {
  return "changed here: " + c.name + " " + c.before + " -> " + c.after;
}

/// Result of a comparison of the options at a restart.
struct Comparison {
  std::vector<std::string> lines;     // one for each option that contradicts the checkpoint
  std::vector<OptionChange> changes;  // those that -restart_change allows
};

/// Compares the options of a configuration with those of the checkpoint; `file` is its name. Options that may
/// change at any restart (change_rules.hpp) are not compared; options whose names (without dash) are in
/// `allowed` may change too.
Comparison compare_options(const Checkpoint& checkpoint, const std::vector<EffectiveOption>& now,
                           const Config& config, const std::string& file,
                           const std::vector<std::string>& allowed = {});

/// Where contact of rigids acts by default stays as it was by default in the checkpoint of options `then`,
/// also where other options changed that decide on it at a start.
void keep_contact(const std::vector<EffectiveOption>& then, Config& config,
                  std::vector<EffectiveOption>& now);

/// Differences between the options in force before and now.
std::vector<OptionChange> changes_between(const std::vector<EffectiveOption>& before,
                                          const std::vector<EffectiveOption>& now);

/// Gives rigids whose motion or velocity changed the velocity that the options now say.
void apply_changes(const std::vector<OptionChange>& changes, const Config& config, SavedState& state);

/// Whether the changes are of a body's material, or of the material's parameters; one entry a body.
std::vector<char> changed_laws(const std::vector<OptionChange>& changes, const Config& config);

/// Changes of the machine or its use that give other bits; empty if there are none. `now` holds the machine
/// and the options with which the run goes on.
std::string changed_machine(const Checkpoint& then, const Checkpoint& now);

}  // namespace mpm
