#pragma once
// Bodies whose particles are listed in a file.

#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// The particles of one body, all of one volume. Vectors have dim components, stresses 4 in 2D and 6 in 3D
/// (xx yy zz xy yz zx); what the file does not have is empty.
struct ParticleTable {
  std::vector<double> position;        // m [dim N]
  std::vector<double> velocity;        // m/s [dim N]
  std::vector<double> stress;          // Pa, tension positive [4 N or 6 N]
  std::vector<double> plastic_strain;  // - [N]
  double particle_volume = 0;          // m3 (m2 in 2D)
};

/// Reads the group of an HDF5 file that is laid out as that of a body in a frame: `position` (N x 3) and
/// `volume` (N), and where they are there `velocity` (N x 3), `stress` (N x 6) and `plastic_strain` (N). In
/// 2D the components that are not in the plane are passed over. Every number must be finite, every particle
/// in the mesh, and the volumes equal to 1e-6, for all particles of a body have one mass. Returns what the
/// file should have been, as the end of "takes ..."; empty where all is well.
std::string read_particles(const std::string& path, const std::string& group, const MeshConfig& mesh, int dim,
                           ParticleTable& table);

}  // namespace mpm
