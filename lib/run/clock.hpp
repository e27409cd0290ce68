#pragma once
// Where a run is in simulated time.

#include "checkpoint/checkpoint.hpp"
#include "run/job.hpp"
#include "step/schedule.hpp"

namespace mpm {

inline constexpr double k_most_steps = 1e12;

struct Clock {
  long step = 0;
  double dt = 0, last_dt = 0;  // s, of a whole step, and of the step before; 0: there is none
  Schedule schedule;
  StageState stage;

  double time() const { return schedule.time_of(step); }
  Schedule::Begin stage_begin() const { return {stage.step, stage.time}; }
  bool is_at_end() const { return stage.over || step >= schedule.last_step(); }  // of the stage
};

/// Ends the run as failed, with a line that says when and why.
PetscErrorCode fail(Job& job, const Clock& clock, const std::string& what);

}  // namespace mpm
