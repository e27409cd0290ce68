#pragma once
// Checkpoints of a run, and the one from which it goes on.

#include <optional>

#include "run/changes.hpp"
#include "run/clock.hpp"
#include "run/time_step.hpp"

namespace mpm {

class Restarts {
 public:
  /// Reads the checkpoint to go on from, and checks it against the options; touches nothing. The clock and
  /// the options become those of the stage in which it was written.
  PetscErrorCode read(Job& job, TimeStep& time_step, Clock& clock);
  /// The checkpoint, until its state is on the device; null in a run from the start.
  Checkpoint* checkpoint() { return checkpoint_ ? &*checkpoint_ : nullptr; }
  /// Rows of the history to go on with.
  const std::string& history_rows() const { return history_rows_; }
  /// Marks the bodies to which -restart_change gives another law.
  const std::vector<char>& laws_changed() const { return laws_changed_; }
  /// `-p2g auto` at a restart keeps the strategy, and with it the bits, where the backend is the same.
  void keep_strategy(Config& config) const;
  /// Log lines of where the run goes on, and of what changes by that. `now`: as describe() has it.
  PetscErrorCode report(Job& job, const Clock& clock, const Checkpoint& now) const;
  /// The checkpoint is on the device: its memory goes.
  void let_go();

  /// Step of the last checkpoint that this run has written; -1: there is none.
  long written() const { return written_; }
  PetscErrorCode write(Job& job, long step, Checkpoint&& checkpoint);
  /// Removes what a run had written in the folder that was further than the checkpoint from which this one
  /// goes on: checkpoints once there is a newer one, frames then or at the end.
  PetscErrorCode forget_later(Job& job, long frames) const;

 private:
  PetscErrorCode find(const Job& job, std::string* fault);
  PetscErrorCode enter_stage(Job& job, TimeStep& time_step, Clock& clock) const;
  std::string compare(Job& job);
  void check(Job& job, const TimeStep& time_step, Clock& clock);
  void check_times(Job& job, const Clock& clock) const;
  bool history_agrees(const Config& config) const;
  void find_history(Job& job);

  std::optional<Checkpoint> checkpoint_;
  std::string file_, history_rows_;
  std::vector<OptionChange> changes_;     // that -restart_change allows
  std::vector<char> laws_changed_;        // of each body, by them
  std::vector<std::string> passed_over_;  // checkpoints that are damaged, as lines for the log
  long began_ = 0;                        // step from which this part of the run goes on
  long written_ = -1;
};

/// A checkpoint of this run but for its state.
Checkpoint describe(const Job& job, const std::string& strategy);

}  // namespace mpm
