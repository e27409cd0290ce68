#pragma once
// Changes of the particles themselves at a rebuild: merging and splitting, and the correction of positions.

#include "step/body_ids.hpp"
#include "step/step_context.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class Resampling {
 public:
  Resampling(StepContext<Space, T, Dim>& run, BodyIds& ids) : run_(run), ids_(ids) {}

  /// Sets up the correction where the run asks for it, and reduces the margin of the lists by its reserve.
  void set_up();
  /// Merges particles that crowd, and splits those whose domains have become too long, where the run asks for
  /// it. Collective.
  PetscErrorCode split_and_merge();
  /// Moves particles to an even density, where the run asks for it, after lists were made. elapsed: time
  /// since the last correction [s]. Collective.
  PetscErrorCode correct_positions(double elapsed);

 private:
  StepContext<Space, T, Dim>& run_;
  BodyIds& ids_;
};

}  // namespace mpm
