#pragma once
// A rigid body on the device.

#include "data/contact_law.hpp"
#include "data/rigid_motion.hpp"
#include "data/surface.hpp"

namespace mpm {

template <int Dim>
struct Rigid : MovingRigid<Dim> {
  RigidPose<Dim> binned;  // where it was when its points were binned
  Surface<Dim> surface;
  bool surface_normal;  // normals from the surface, not from the mass gradient
  ContactLaw law;
  double mass_cut;  // kg, nodes below it are not touched
};

}  // namespace mpm
