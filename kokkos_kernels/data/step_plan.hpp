#pragma once
// How the steps between two rebuilds are done: chosen once, by plan_step.

namespace mpm {

/// The forms of a step. lib/step/step.cpp lists the functions of each.
enum class StepForm {
  separate,    // the paper's functions one after the other
  fused,       // particles pass through memory once: function 5 goes on to functions 1 and 3 of the next step
  overlapped,  // on several ranks: the sums at shared nodes travel while inner patches are computed
  out_of_core,  // the soil passes through the device's memory in batches
  persistent,   // a launch does many steps; those that it cannot do are fused
};

struct StepPlan {
  StepForm form = StepForm::separate;
  /// Function 5 goes on to functions 1 and 3 of the next step, the soil's boundary included.
  bool sums_ahead = false;
  /// Function 3 writes the sums of all nodes. Else it adds to what function 1 has set to zero.
  bool writes_sums = false;
  /// Function 4 has a kernel of its own for the nodes near rigids.
  bool nodes_apart = false;
  /// This kernel may run on the overlap stream.
  bool nodes_aside = false;
};

}  // namespace mpm
