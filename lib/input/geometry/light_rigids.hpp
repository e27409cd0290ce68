#pragma once
// Rigid bodies that are light against the soil that they touch.

#include <cmath>

#include "mpm/config.hpp"

namespace mpm {

/// Mass of a rigid body, and of a layer of cells of the heaviest soil at the largest face of its bounds [kg].
struct Lightness {
  double mass = 0, layer = 0;
  /// Smallest ratio [-] of the moment of inertia of the body to that of a layer of soil round it; infinite
  /// for a body that does not turn or to which soil does not stick on all sides.
  double turning = HUGE_VAL;

  /// Contact at nodes that takes such a body as infinitely heavy throws it up: a disc of half a cell that
  /// falls on clay begins to gain energy at a quarter of a layer, one of one and a half cells at a third.
  bool is_light() const { return mass < layer || turning < 1; }
};

/// Lightness of a rigid body, by the largest of the faces across the axes along which it may move; one that
/// no force moves is not light. Both masses are of the part that planes of symmetry leave in the mesh.
Lightness lightness_of(const Config& config, const RigidConfig& rigid);

/// Whether a joint holds a rigid body of the run.
bool is_jointed(const Config& config, const RigidConfig& rigid);

/// Whether contact takes a light rigid body with its velocity at the end of the step. It does so at nodes,
/// and where no joint or spring acts on the body.
bool solves_for_velocity(const Config& config, const RigidConfig& rigid);

}  // namespace mpm
