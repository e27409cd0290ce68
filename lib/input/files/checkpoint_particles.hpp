#pragma once
// The particles of a body as a checkpoint holds them, for another run to start from.

#include "data/saved_state.hpp"
#include "input/files/particle_file.hpp"

namespace mpm {

/// Reads the body source.group of a checkpoint of any number of ranks. The positions are absolute: the mesh
/// may be another than that of the checkpoint's run, the dimension may not. Returns what the file should have
/// been, as the end of "takes ..."; empty where all is well.
std::string read_checkpoint_particles(const ParticleSource& source, const MeshConfig& mesh, int dim,
                                      ParticleTable& table);

/// Where points of a saved state of a run with this mesh are [m, packed by dim].
std::vector<double> positions_of(const SavedPoints& points, const MeshConfig& mesh, int dim);

}  // namespace mpm
