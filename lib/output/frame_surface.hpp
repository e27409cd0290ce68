#pragma once
// Surfaces of triangles in frames: the groups NAME_surface.

#include <hdf5.h>
#include <petscsys.h>

#include <string>

#include "common/snapshot.hpp"

namespace mpm {

/// Group of a frame's file that has the surface of a rigid body.
std::string surface_group(const std::string& rigid);

/// Writes `vertices` (float64, N x 3, m) and `triangles` (int32, M x 3, of vertices from 0 on). Nothing where
/// the body has no triangles. `path` is for messages.
PetscErrorCode write_surface(hid_t file, const std::string& path, const ParticleSnapshot& rigid);

/// Counts of vertices and triangles in a frame's file; zeros where it has no such group.
struct SurfaceSize {
  long vertices = 0, triangles = 0;
};
SurfaceSize surface_size(hid_t file, const std::string& rigid);

/// The grid of a surface in particles.xdmf; `file` is the frame's.
std::string surface_grid(const std::string& file, const std::string& rigid, const SurfaceSize& size);

}  // namespace mpm
