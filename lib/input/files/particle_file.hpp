#pragma once
// Bodies whose particles are listed in a file: of the user's, or of a run, which another one starts from.

#include <string>
#include <vector>

#include "common/snapshot.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// The particles of one body in a file; a column that the file does not have is empty. `state` and
/// `own_parameters` are those that the source asked for.
struct ParticleTable : ParticleColumns {
  long put_inside = 0;  // particles that were less than half a cell outside the mesh, as a run may leave them
  std::string origin{};  // "frame of step 12, 0.5 s"; empty for a file of the user's own
};

/// Where a body's particles are, and what of them is asked for.
struct ParticleSource {
  std::string path, group;                // group: the name of the body in the file
  bool velocity = true, stress = true;    // false: options give it for all particles
  std::vector<std::string> state{};       // the state variables that the body's law changes
  std::vector<std::string> parameters{};  // that each particle may have its own values of
};

/// Whether options leave a column to the file.
bool wanted(const ParticleColumn& column, const ParticleSource& source);

/// Reads the particles of a body from an HDF5 file: a checkpoint, a frame, or a file laid out as one, with a
/// group that holds `position` (N x 3) and `volume` (N), and where they are there `velocity` (N x 3),
/// `stress` (N x 6; total where there is a `pore_pressure` (N), else effective), the state variables, `mass`,
/// `reference_height` and the source's parameters (N). A frame must hold all of them that its run had, for
/// otherwise its -output_fields left them out; one of an earlier version (without the attribute `dim`)
/// counts as a file of the user's. In 2D the components that are not in the plane are passed over. Every
/// number must be finite, every particle in the mesh, volumes and masses greater than 0. Returns what the
/// file should have been, as the end of "takes ..."; empty where all is well.
std::string read_particles(const ParticleSource& source, const MeshConfig& mesh, int dim,
                           ParticleTable& table);

/// Adds the pressures [Pa] of particles to the normal stresses; nothing where there are none.
void add_pressure(const std::vector<double>& pressure, int dim, std::vector<double>& stress);

/// The mean density of the particles of a table [kg/m3]; that of the material where it has no masses.
double mean_density(const ParticleTable& table, double of_material);

/// How many particles the file lists for a group, of a checkpoint for all, from the sizes alone; 0 where that
/// cannot be read.
long listed_particles(const std::string& path, const std::string& group);

/// Takes out the particles whose centre is in one of the shapes, and returns their number.
long cut_particles(const std::vector<Shape>& cut_out, const MeshConfig& mesh, int dim, ParticleTable& table);

}  // namespace mpm
