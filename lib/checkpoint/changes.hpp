#pragma once
// What may change between a run and its continuation.

#include <string>
#include <vector>

#include "checkpoint/checkpoint.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// The options in force with the checksums of the files that list particles in lieu of these files' names, so
/// that a file may move and may not change.
std::vector<EffectiveOption> options_to_keep(const std::vector<EffectiveOption>& options,
                                             const Config& config);

/// A line for each option that contradicts the checkpoint; `file` is its name. Options of output, of the
/// machine and of the end of the run may change.
std::vector<std::string> contradictions(const Checkpoint& checkpoint, const std::vector<EffectiveOption>& now,
                                        const std::string& file);

/// What goes on otherwise than it was and so gives other bits; empty if nothing. `now` tells the machine and
/// the options with which the run goes on.
std::string changed_machine(const Checkpoint& then, const Checkpoint& now);

/// What is wrong with the state for this mesh and these bodies ("takes ..."); empty if nothing.
std::string state_fault(const SavedState& state, const Config& config);

}  // namespace mpm
