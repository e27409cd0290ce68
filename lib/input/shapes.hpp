#pragma once
// Geometry: what is inside a shape, and the lattice of particles that fills it. "Inside" includes the
// boundary, with a tolerance of 1e-9 of the mesh spacing, so that round-off never decides.

#include <petscsys.h>

#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// The particles of a shape. The volumes are areas [m2] in 2D.
struct Lattice {
  std::vector<double>
      position;        // m, packed: component c of particle k is position[k * dim + c]; x varies fastest
  double spacing = 0;  // m, between neighbouring particles
  double particle_volume = 0;  // m3, spacing^dim
  double shape_volume = 0;     // m3, of the shape itself, exact
};

/// Fills a shape with particles, shape.particles_per_cell in each direction of a cell.
/// Fill::centre: the lattice points in the shape. The lattice of a box starts at the box's own lower corner,
/// that of another shape is the mesh's. Fill::cell: all particles of every mesh cell that lies wholly in the
/// shape. A polygon needs dim == 2.
PetscErrorCode fill(const Shape& shape, const MeshConfig& mesh, int dim, Lattice& lattice);

/// Whether fill() would give at least one particle; stops at the first.
bool holds_particle(const Shape& shape, const MeshConfig& mesh, int dim);

/// Volume [m3] (area [m2] in 2D) of a shape. A fillet rounds all corners of a box (quarter circles), and in
/// 3D all edges and corners (quarter cylinders, eighths of a ball).
double shape_volume(const Shape& shape, int dim);

/// The smallest box that holds a shape.
struct Bounds {
  Vec3 lower{}, upper{};  // m; the third component is 0 in 2D
};
Bounds bounds_of(const Shape& shape, int dim);

}  // namespace mpm
