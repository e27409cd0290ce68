#pragma once
// Bodies that a stage removes and places, and materials that it changes.

#include <algorithm>

#include "check/overlap.hpp"
#include "common/model.hpp"
#include "run/clock.hpp"
#include "step/stepper.hpp"

namespace mpm {

/// Whether the stage begins with another soil than the stage before ends with.
bool changes_soil(const StageConfig& stage);

/// The soil and the rigids that the stage removes, and those that it places: soil in the shapes of what it
/// places goes where -NAME_cut_out says so, and all other overlaps are a failure.
PetscErrorCode change_bodies(Job& job, const Clock& clock, SavedState& state, Present* present);

/// Marks the particles of a model that are not in the run: of bodies that are not placed yet; where the stage
/// places soil (`present`), all others too, which the saved state has, and what of the placed soil is cut.
PetscErrorCode leave_out(Job& job, const Clock& clock, const Present* present, Model* model);

/// Bodies whose state in a new stepper is not the saved one: `changed`, one entry a body: its law or
/// parameters are others than before; `placed`: bodies that are new.
struct NewBodies {
  std::vector<char> changed;
  std::vector<int> placed;
  bool all_were_there = false;  // at a restart

  bool any_changed() const { return std::find(changed.begin(), changed.end(), 1) != changed.end(); }
};

/// The state of the soil for the stepper that is set up: with the bodies that it places, and the state
/// variables of its laws.
PetscErrorCode adapt_state(Job& job, const Clock& clock, const Stepper& stepper, const NewBodies& bodies,
                           SavedState& state);

/// The surfaces of the loads that begin with the stage.
PetscErrorCode find_loads(Job& job, const Clock& clock, SavedState& state);

}  // namespace mpm
