#pragma once
// Terms of the motion of a rigid body that a checkpoint keeps, as numbers in a table.

namespace mpm {

/// Numbers of a rigid body, in 2D too: its displacement [m], velocity [m/s], impulse of the soil on it since
/// the last row [N s] with its moment [N m s], and its displacement when its points were binned [m]; then its
/// rotation (the angle, or a quaternion), that when its points were binned, its angular momentum [kg m2/s],
/// and its angular velocity [rad/s].
struct MotionTerms {
  static constexpr int displacement = 0, velocity = 3, impulse = 6, moment = 9, binned = 12, rotation = 15,
                       binned_rotation = 19, momentum = 23, spin = 26, turns = 29, size = 30;
  static constexpr int impulse_size = binned - impulse;  // numbers of the impulse
};

}  // namespace mpm
