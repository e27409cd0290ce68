#pragma once
// Terms of the motion of a rigid body that a checkpoint keeps, as numbers in a table.

namespace mpm {

/// Numbers of a rigid body, in 2D too: its displacement [m], velocity [m/s], and impulse of the soil on it
/// since the last row [N s], and its displacement when its points were binned [m], which follow from it.
struct MotionTerms {
  static constexpr int displacement = 0, velocity = 3, impulse = 6, binned = 9, size = 12;
  static constexpr int impulse_size = binned - impulse;  // numbers of the impulse
};

}  // namespace mpm
