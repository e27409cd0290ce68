#pragma once
// Results that a run writes while it goes: rows of the history, frames, rasters, partition.csv.

#include "check/energy_watch.hpp"
#include "check/notices.hpp"
#include "output/frame_queue.hpp"
#include "output/history.hpp"
#include "run/probes.hpp"

namespace mpm {

class Outputs {
 public:
  /// Begins the files of a new run. `columns`: a Config with the columns of the history.
  PetscErrorCode open(Job& job, const Config& columns);
  /// Takes over what a checkpoint holds of the results; touches no file.
  void take(Checkpoint& c) { probes_.go_on(c), last_row_.time = c.run.last_row_time; }
  /// Goes on with the files of the folder, after these rows and so many frames.
  PetscErrorCode go_on(Job& job, const Config& columns, const std::string& rows, long frames);
  /// Brings all that was written to the disk, and marks its end in a checkpoint.
  PetscErrorCode settle(const Job& job, Checkpoint* checkpoint);
  PetscErrorCode close(Job& job, Stepper& stepper);

  /// Appends a row, and watches it: the run may fail by it.
  PetscErrorCode write_row(Job& job, const Clock& clock, double wall, Stepper& stepper);
  PetscErrorCode write_frame(const Job& job, const Clock& clock, Stepper& stepper);
  /// Rasters and frames whose turn has come, or those that a longer run would not have at this step.
  PetscErrorCode write_fields(const Job& job, const Clock& clock, bool in_turn, Stepper& stepper);

  /// Another stage begins: its bodies may be others.
  void begin_stage() { notices_.begin_stage(), watching_ = false; }

  Probes& probes() { return probes_; }
  const HistoryRow& last_row() const { return last_row_; }
  long frames() const { return frames_.count(); }

 private:
  PetscErrorCode watch(Job& job, const Clock& clock);
  PetscErrorCode write_partition(const Job& job, const Clock& clock, Stepper& stepper);

  History history_;
  FrameQueue frames_;
  std::string partition_rows_;  // of partition.csv
  Probes probes_;
  HistoryRow last_row_;
  EnergyWatch energy_;
  bool watching_ = false;  // energy has begun
  Notices notices_;
};

}  // namespace mpm
