#pragma once
// Measures of bodies, cells and rigid bodies for a row of the history, and of the run's equilibrium and
// speeds.

#include "step/step_context.hpp"
#include "transfer/measure.hpp"

namespace mpm {

/// All measures are of all ranks, and collective.
template <class Space, class T, int Dim>
class HistoryMeasures {
 public:
  explicit HistoryMeasures(StepContext<Space, T, Dim>& run) : run_(run) {}

  /// Measures all bodies, and leaves the nodal sums of the soil as it is.
  PetscErrorCode measure_bodies(std::vector<BodyRow>* rows);
  /// Counts the cells that hold soil, and gaps between them.
  PetscErrorCode count_cells(HistoryRow* row) const;
  /// Measures the rigid bodies, and takes their impulses since the last row, an interval [s] ago.
  PetscErrorCode measure_rigids(double interval, HistoryRow* row);
  /// Sums over all ranks the soil that has left the run, and gathers on every rank the cells whose particles
  /// are alone.
  PetscErrorCode save_strays(SavedState* saved) const;
  /// Functions of Stepper; dt: length of a step [s].
  PetscErrorCode unbalanced_ratio(double dt, double* ratio);
  PetscErrorCode fastest_wave(double compression, double* speed) const;
  PetscErrorCode closing_speed(double* speed) const;

 private:
  /// Measures the parts of rigid bodies that have rows, and takes their impulses.
  void measure_parts(double interval, HistoryRow* row);
  PetscErrorCode measure_interfaces(double interval, HistoryRow* row);
  PetscErrorCode measure_body(int body, BodyRow* row) const;
  PetscErrorCode sum_measure(BodyMeasure* m) const;
  /// Measures soil that has left the run, and counts particles that were put back on a wall.
  PetscErrorCode measure_strays(int body, BodyRow* row) const;

  StepContext<Space, T, Dim>& run_;
};

}  // namespace mpm
