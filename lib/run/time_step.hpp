#pragma once
// The length of the time step: at the start, and where it follows the stiffness of the soil.

#include "run/clock.hpp"
#include "step/stepper.hpp"

namespace mpm {

/// Chooses the clock's step and schedule from the options, and follows the soil where that becomes stiffer or
/// its domains stretch.
class TimeStep {
 public:
  /// The step from the Courant number (Eq. 14), or the user's where it is stable; else a line in the report.
  PetscErrorCode choose(Job& job, Clock& clock);
  /// Log lines of the step at the start.
  PetscErrorCode report(Job& job, const Clock& clock) const;

  /// Whether the step follows the stiffness of the soil and its domains, or is held against them.
  bool follows() const { return follows_; }
  /// The step at which follow() has something to do.
  long next_check(const Clock& clock) const;
  /// If the stiffness of some soil changes, as often as look_ahead() says; `now`: at this step too. Computes
  /// the step by the Courant number from the fastest wave until the next look. If the user has fixed the
  /// step, the run fails once that is not stable.
  PetscErrorCode follow(Job& job, Stepper& stepper, bool now, Clock& clock);

  /// Another stepper, or the same soil under other laws: all is computed anew.
  void begin_stage(const Clock& clock) { logged_ = 0, computed_at_ = -1, waves_ = {.due = clock.step}; }
  const WaveWatch& waves() const { return waves_; }
  void go_on(const WaveWatch& waves) { waves_ = waves, waves_.every = std::max(1L, waves.every); }

 private:
  PetscErrorCode look_ahead(const Config& config, Stepper& stepper, long step, double* speed);

  bool follows_ = false;
  bool laws_follow_ = false;  // the stiffness of some soil changes
  long computed_at_ = -1;     // step of the last computation of wave speeds
  WaveWatch waves_;           // when the next one is due
  double logged_ = 0;         // s, the last step that the log has
};

}  // namespace mpm
