#pragma once
// Mapping of the state variables of soil whose law or parameters change between two steps, and of particles
// that join the soil there.

#include <string>
#include <vector>

#include "data/saved_state.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Whether each body has another law, other parameters or other pore water than before. Of one that is not in
/// the run it counts too: the bodies share the fields of state variables.
std::vector<char> changed_laws(const Config& before, const Config& now);

/// Brings the state variables of `state` into the fields of `fresh`, a state of a stepper for `now`. A body
/// that is `changed` keeps its stress, and by their names the variables that its law changes or that are each
/// particle's own; the others begin as in soil of its law that is created with this stress where the particle
/// is. Where pores drain from now on, the stress stays the effective stress: the excess pore pressure is
/// gone. Returns why a law cannot start there; empty where all can.
std::string map_state(const Config& now, const std::vector<char>& changed, const SavedState& fresh,
                      SavedState& state);

/// Adds the particles that some bodies have in `fresh`, with their ids, and what is known of these bodies.
void add_bodies(const std::vector<int>& bodies, const SavedState& fresh, SavedState& state);

}  // namespace mpm
