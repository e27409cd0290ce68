// Particles of a file that are in the place of something else.

#include "input/files/particle_file.hpp"
#include "input/geometry/region.hpp"

namespace mpm {
long cut_particles(const std::vector<Shape>& cut_out, const MeshConfig& mesh, int dim, ParticleTable& table) {
  if (cut_out.empty() || table.position.empty()) return 0;
  std::vector<Region> holes;
  for (const Shape& shape : cut_out) holes.emplace_back(shape, dim, 1e-9 * mesh.spacing);
  std::vector<char> out(table.position.size() / dim);
  long count = 0;
  for (std::size_t row = 0; row < out.size(); ++row) {
    Vec3 x{};
    for (int d = 0; d < dim; ++d) x[d] = table.position[row * dim + d];
    for (Region& hole : holes) {
      hole.enter_row(x[dim - 1], x[dim - 1]);
      if (hole.holds(x)) out[row] = 1;
    }
    count += out[row];
  }
  remove_rows(out, table);
  return count;
}

}  // namespace mpm
