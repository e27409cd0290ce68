#pragma once
// Joints between rigid bodies, and springs and dashpots that hold them: a part of State.

#include "base/spaces.hpp"
#include "data/rigid_motion.hpp"

namespace mpm {

/// Relative rotation of two bodies that a joint holds: none, all but that about its axis, or all.
enum class HeldTurn : int { none, about_others, all };

/// A joint between two rigid bodies, or a body and the ground: what it holds of their relative motion, and
/// the reaction since the host last took it. Ends and axes are those at the start.
template <int Dim>
struct Joint {
  static constexpr int k_ground = -1;
  int body[2] = {k_ground, k_ground};  // a joint whose first body is the ground is not in the run
  Vector<double, Dim> end[2] = {};     // m, of the first body, and of the second one or the ground
  Vector<double, Dim> axes[Dim] = {};  // -, orthogonal: the joint's axis, and those across it
  bool holds_point = false;            // the ends stay together
  bool slides = false;                 // they stay together across the axis
  bool holds_length = false;           // they stay at the length,
  bool pulls_only = false;             // or within it
  bool stops = false;                  // the angle between the bodies stays between the stops
  HeldTurn held_turn = HeldTurn::none;
  double length = 0;                  // m
  double stop[2] = {};                // rad
  Vector<double, Dim> velocity = {};  // m/s, of the end on the ground
  Vector<double, Dim> way = {};       // m, of this end since the start
  Wrench<Dim> impulse = {};           // N s, N m s, on the first body, the moment about its end
  Wrench<Dim> of_step = {};           // N s, N m s, in the step at hand
  double peak = 0;                    // N, largest force in a step
  double work = 0;                    // J, of the end on the ground since the start

  /// Conditions that it sets.
  KOKKOS_INLINE_FUNCTION int rows() const {
    if (body[0] == k_ground) return 0;
    const int turns = held_turn == HeldTurn::all ? k_turning_axes<Dim> : held_turn == HeldTurn::none ? 0 : 2;
    return turns + (holds_point ? Dim : 0) + (slides ? Dim - 1 : 0) + (holds_length ? 1 : 0) +
           (stops ? 1 : 0);
  }
};

/// Springs and dashpots that hold a rigid body, about its place at the start, and the point about which the
/// history has the moment of the soil.
template <int Dim>
struct RigidSupport {
  bool on = false;              // it has springs or dashpots
  Wrench<Dim> stiffness = {};   // N/m, N m/rad, along and about the axes of space
  Wrench<Dim> viscosity = {};   // N s/m, N m s/rad
  Wrench<Dim> impulse = {};     // N s, N m s, on the body since the host last took it
  bool has_point = false;       // the moment of the soil is about a point of the body,
  Vector<double, Dim> point{};  // m, at the start
};

/// A condition of a joint, linear in the velocities: direction . (v1 - v2) + moment1 . w1 - moment2 . w2 is
/// the velocity of its error, and the impulse along it acts on the bodies so.
template <int Dim>
struct JointRow {
  int joint = 0;
  int body[2] = {};                      // of the joint
  Vector<double, Dim> direction = {};    // -; 0 of a condition on rotations
  AngularVector<Dim> moment[2] = {};     // m, or - of a condition on rotations
  AngularVector<Dim> couple = {};        // -, part of the first moment that no force at the end has
  Vector<double, Dim> velocity[2] = {};  // (m/s)/(N s), what an impulse of 1 gives each body
  AngularVector<Dim> spin[2] = {};       // (rad/s)/(N s)
  double error = 0;                      // m or rad; one-sided: above 0 is too far
  double scale = 1;                      // m or rad, that the error is compared with
  double drive = 0;                      // m/s, of the ground's end along the direction
  bool one_sided = false;                // the impulse may not be above 0
  bool active = true;
};

/// Places of a rigid body in the course of a step.
template <int Dim>
struct LinkedStart {
  RigidPose<Dim> pose;            // before the step
  Vector<double, Dim> kick = {};  // m/s, of half a step, by what does not depend on the place
  AngularVector<Dim> turn = {};   // kg m2/s, likewise
};

template <class Space, int Dim>
struct RigidLinks {
  using Memory = typename Space::memory_space;
  Kokkos::View<Joint<Dim>*, Memory> joints;
  Kokkos::View<RigidSupport<Dim>*, Memory> supports;  // of each rigid; empty: nothing links the bodies
  Kokkos::View<JointRow<Dim>*, Memory> rows;          // of all joints, before and behind the movement
  Kokkos::View<double*, Memory> matrix;               // [rows rows], row by row
  Kokkos::View<double*, Memory> numbers;              // k_numbers [rows]
  Kokkos::View<int*, Memory> first;                   // column of a row of the matrix where it begins
  Kokkos::View<LinkedStart<Dim>*, Memory> starts;     // of each rigid
  double size = 1;                                    // m, of the mesh
  static constexpr int k_numbers = 3;

  bool in_use() const { return supports.extent(0) > 0; }
  int row_count() const { return static_cast<int>(first.extent(0)); }
};

}  // namespace mpm
