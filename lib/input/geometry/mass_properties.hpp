#pragma once
// Volume, centre of mass and inertia of shapes.

#include <optional>

#include "mpm/config.hpp"

namespace mpm {

/// Mass properties of a homogeneous solid of density 1; those of another density are so many times the volume
/// and the inertia. In 2D those of the plane section, 1 m long, also where it is that of a revolution.
struct MassProperties {
  double volume = 0;  // m3 (m2 in 2D)
  Vec3 centre{};      // m, centre of mass; the third component is 0 in 2D
  /// m5 (m4 in 2D), inertia tensor about the centre, along the axes of the mesh, with x the position from the
  /// centre: xx is the integral of y^2 + z^2, and xy is minus the integral of x y. In 2D only zz, the polar
  /// second moment of area, is not 0.
  Sym6 inertia{};
};

/// Mass properties of a whole shape, by closed forms, also where planes of symmetry would cut it; what parts
/// of a union share by points (united_properties). None of a half plane and a layer, which end with the mesh,
/// and of a list of particles.
std::optional<MassProperties> mass_properties(const Shape& shape, int dim);

/// Mass of the part of a rigid body that is in the mesh [kg; kg/m in plane strain]: -NAME_mass, or by its
/// density; of a body of revolution, of the whole ring, and an estimate where the axis cuts its section (the
/// radius of the middle stands for that of the centroid).
double mass_of(const Config& config, const RigidConfig& rigid);

/// Mass properties of a shape with its mirror images beyond the planes of symmetry that cut it. Round shapes
/// are taken for their own images, as they are where their centre is in the plane.
std::optional<MassProperties> whole_properties(const Shape& shape, const MeshConfig& mesh, int dim);

}  // namespace mpm
