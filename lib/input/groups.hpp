#pragma once
// The groups of options, each read at one place. All report their mistakes to the reader.

#include <string>
#include <vector>

#include "input/particle_file.hpp"
#include "input/reader.hpp"

namespace mpm {

/// -mesh_*. Whether the mesh is sound, so that shapes can be checked against it.
bool read_mesh(OptionReader& in, int dim, MeshConfig& mesh);

/// The options of one material: its density, its model and the model's own table of parameters.
void read_material(OptionReader& in, const std::string& name, MaterialConfig& material);

/// The geometry and lattice of a body or rigid. Whether all of it was sound. Only where `listed` may a file
/// list the particles.
bool read_shape(OptionReader& in, const std::string& name, int dim, bool listed, Shape& shape);

/// Checks that a sound shape lies in the mesh and holds a particle.
void check_shape(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                 int dim);

/// Reads the particles that a file lists, and checks them.
void check_particles(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                     int dim, ParticleTable& table);

/// -materials, -bodies, -rigids and the options of each that they name. The fixed options must have been read
/// before, since no name may begin as they do. A null mesh (unsound) leaves the shapes unchecked against it.
void read_named(OptionReader& in, const MeshConfig* mesh, Config& config);

}  // namespace mpm
