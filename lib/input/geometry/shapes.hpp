#pragma once
// The lattice of particles that fills a shape, and the shape's size.

#include <petscsys.h>

#include <string>
#include <utility>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// The particles of a shape. The volumes are areas [m2] in 2D.
struct Lattice {
  int dim = 0;
  std::vector<double>
      position;        // m, packed: component c of particle k is position[k * dim + c]; x varies fastest
  double spacing = 0;  // m, between neighbouring particles
  double particle_volume = 0;  // m3, spacing^dim
  std::vector<double> volume;  // m3, of each particle; or empty where particle_volume holds for all
  double shape_volume = 0;     // m3, of the shape itself, exact, with what is cut out of it
  long cut_out = 0;            // particles left out
  double cut_volume = 0;       // m3, of these

  double held_volume() const;  // m3, of all particles here
};

/// Which part of a lattice one rank makes: of so many equal lots of rows or, in 3D, layers, that of this
/// number. The parts one after the other are the lattice.
struct LatticePart {
  int number = 0, of = 1;
};

/// Fills a shape with particles, shape.particles_per_cell in each direction of a cell.
/// Fill::centre: the lattice points in the shape. The lattice of a box starts at the box's own lower corner
/// and turns with it; that of another shape is the mesh's. Fill::cell: all particles of every mesh cell that
/// lies wholly in the shape. Particles whose centre is in one of the shapes `cut_out` are left out.
/// Fill::cut: the parts of the lattice's cells that are in the shape, each a particle at the part's centre
/// with its volume; a part of less than an eighth of a cell joins a neighbour's. "In" includes the boundary,
/// with a tolerance of 1e-9 of the mesh spacing, so that round-off never decides. Nothing is filled beyond
/// the mesh: a box that it cuts has the lattice of the box that ends there. ShapeKind::particles has no
/// lattice (PETSC_ERR_SUP).
PetscErrorCode fill(const Shape& shape, const MeshConfig& mesh, int dim, Lattice& lattice,
                    const std::vector<Shape>& cut_out = {}, LatticePart part = {});

/// Bytes that fill() needs beside the particles: Fill::cut keeps some levels of cells as a whole.
double fill_bytes(const Shape& shape, const MeshConfig& mesh, int dim);

/// Whether fill() would give at least one particle; stops at the first.
bool holds_particle(const Shape& shape, const MeshConfig& mesh, int dim,
                    const std::vector<Shape>& cut_out = {});

/// The options that name files of the shape of a body and of its parts, and these files.
std::vector<std::pair<std::string, std::string>> files_of(const std::string& name, const Shape& shape);

/// The shapes that are cut out of a body as it is placed: those of bodies and rigids that are placed at the
/// same time. A shape that is placed earlier or later cuts when the later of the two is placed (overlap.hpp).
std::vector<Shape> cut_out_of(const Config& config, const BodyConfig& body);

/// Volume [m3] (area [m2] in 2D) of a shape, or of the part of it in the mesh where sides of the mesh cut it;
/// of a half plane, that of the mesh behind it. A fillet rounds all corners of a box (quarter circles), and
/// in 3D all edges and corners (quarter cylinders, eighths of a ball).
double shape_volume(const Shape& shape, const MeshConfig& mesh, int dim);

/// The smallest box that holds a shape; of a half plane, one round what is behind it in the mesh.
struct Bounds {
  Vec3 lower{}, upper{};  // m; the third component is 0 in 2D
};
Bounds bounds_of(const Shape& shape, const MeshConfig& mesh, int dim);
/// Part of the bounds that is in the mesh.
Bounds within(Bounds bounds, const MeshConfig& mesh, int dim);

/// Smallest width [m] of a shape or of a part of a union: of the edges of a box that is turned, else of the
/// bounds, along axes on which they end within the mesh. Infinite for a half plane.
double narrowest(const Shape& shape, const MeshConfig& mesh, int dim);

/// Least width of a shape with contact at sites [cells]: a face of 1.1 cells has one row of sites.
inline constexpr double k_wide_for_sites = 2;

/// Whether a shape has no flat faces so narrow that contact at sites, which keep off sharp edges by 0.55
/// cells, may let soil through. Discs and half planes have no edges.
bool is_wide_for_sites(const Shape& shape, const MeshConfig& mesh, int dim);

/// The sides of the mesh that a shape reaches beyond, and so is cut by: [direction][0 lower, 1 upper].
using Cuts = std::array<std::array<bool, 2>, 3>;
Cuts cuts_of(const Shape& shape, const MeshConfig& mesh, int dim);

}  // namespace mpm
