#pragma once
// A rigid body on the device.

#include "data/rigid_motion.hpp"
#include "data/surface.hpp"

namespace mpm {

template <int Dim>
struct Rigid : MovingRigid<Dim> {
  RigidPose<Dim> binned;  // where it was when its points were binned
  Surface<Dim> surface;
  bool surface_normal;    // normals from the surface, not from the mass gradient
  bool separates;         // the soil may part from it
  double reach;           // m, gap at which the contact ends; 0: it does not depend on the gap
  double exponent;        // -, of its decrease with the gap
  double shear_limit;     // Pa, infinite where only the friction limits
  double shear_fraction;  // -, of the soil's strength instead of the limit; negative: none
  double friction;        // -, negative: none
  double mass_cut;        // kg, nodes below it are not touched
};

}  // namespace mpm
