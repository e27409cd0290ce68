#pragma once
// Terms of the motion of a rigid body and of what links it that a checkpoint keeps, as numbers in tables.

namespace mpm {

/// Numbers of a rigid body, in 2D too: its displacement [m], velocity [m/s], impulse of the soil on it since
/// the last row [N s] with its moment [N m s], and its displacement when its points were binned [m]; then its
/// rotation (the angle, or a quaternion), that when its points were binned, its angular momentum [kg m2/s],
/// and its angular velocity [rad/s]; and whether it has these (`turns`, 0 where not; k_new_spin where a stage
/// sets the angular velocity, from which the angular momentum follows).
struct MotionTerms {
  static constexpr int displacement = 0, velocity = 3, impulse = 6, moment = 9, binned = 12, rotation = 15,
                       binned_rotation = 19, momentum = 23, spin = 26, turns = 29, size = 30;
  static constexpr int impulse_size = binned - impulse;  // numbers of the impulse
  static constexpr double k_new_spin = 2;
};

/// Numbers of a joint, in 2D too: way of its end on the ground [m], impulse on its first body since the last
/// row [N s] with its moment about the joint's point [N m s], largest force since then [N], work [J].
struct JointTerms {
  static constexpr int way = 0, impulse = 3, moment = 6, peak = 9, work = 10, size = 11;
};

/// Numbers of the springs and dashpots of a rigid body, in 2D too: their impulse since the last row [N s],
/// and its moment [N m s].
struct SupportTerms {
  static constexpr int impulse = 0, moment = 3, size = 6;
};

/// Numbers of a part of a rigid body, in 2D too: number of the body, number of the part in it, impulse of the
/// soil on it since the last row [N s], and its moment [N m s].
struct PartTerms {
  static constexpr int rigid = 0, part = 1, impulse = 2, moment = 5, size = 8;
};

}  // namespace mpm
