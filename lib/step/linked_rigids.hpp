#pragma once
// Joints, springs and dashpots of rigid bodies, between configuration, state, history and checkpoints. All
// ranks compute them alike.

#include "step/step_context.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class LinkedRigids {
 public:
  explicit LinkedRigids(StepContext<Space, T, Dim>& run) : run_(run) {}

  /// Puts joints and springs on the device. Before the loads, which move ends of joints, and the upload.
  void set_up();
  /// Measures joints and springs for a row that has its rigid bodies. interval [s]: since the last row.
  void measure(double interval, HistoryRow* row);
  void save(SavedState* saved) const;
  /// Goes on with the ways, impulses and works of a checkpoint, where it has them.
  void restore(const SavedState& saved);

 private:
  StepContext<Space, T, Dim>& run_;
};

}  // namespace mpm
