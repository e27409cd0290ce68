#pragma once
// Gravity and loads on surfaces, between configuration, state, history and checkpoints.

#include "step/step_context.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class AppliedLoads {
 public:
  explicit AppliedLoads(StepContext<Space, T, Dim>& run) : run_(run) {}

  /// Puts the loads on the device, before the particles. face_count: loads that a particle is on at most.
  /// carried: by rigid, the mass whose weight its force includes [kg].
  void set_up(int face_count, const std::vector<double>& carried);
  /// Sets loads that follow tables to a time [s], for a measurement; the next step sets its own.
  void set_time(double time);
  /// Measures force and area of each load for a row of the history, and the work of all. Collective.
  PetscErrorCode measure(HistoryRow* row) const;
  /// Saves the work, behind the works of the energy balance. Collective.
  PetscErrorCode save(SavedState* saved) const;
  void restore(const SavedState& saved);

 private:
  /// Work of the loads since the start, of all ranks [J].
  PetscErrorCode work(double* work) const;

  StepContext<Space, T, Dim>& run_;
};

}  // namespace mpm
