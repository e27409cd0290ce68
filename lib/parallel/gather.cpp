#include "parallel/gather.hpp"

#include <algorithm>
#include <cstring>

#include "parallel/together.hpp"

namespace mpm {
namespace {

/// The fields of a body's particles and their widths.
struct Part {
  std::vector<double> ParticleSnapshot::*values;
  int width;
};
constexpr Part k_parts[] = {{&ParticleSnapshot::position, 3}, {&ParticleSnapshot::velocity, 3},
                            {&ParticleSnapshot::grid_velocity, 3}, {&ParticleSnapshot::stress, 6},
                            {&ParticleSnapshot::volume, 1}, {&ParticleSnapshot::plastic_strain, 1}};

}  // namespace

// Field by field, so that rank 0 holds one of them twice, not all.
PetscErrorCode gather_particles(MPI_Comm comm, ParticleSnapshot* body) {
  PetscFunctionBeginUser;
  const std::size_t here = body->id.size();
  for (const auto& [values, width] : k_parts) {
    const std::size_t row = width * sizeof(double), size = sizeof(double) + row;
    std::vector<std::vector<char>> out(size_of(comm));
    out[0].resize(here * size);
    for (std::size_t p = 0; p < here; ++p) {
      const double id = body->id[p];
      std::memcpy(&out[0][p * size], &id, sizeof id);
      std::memcpy(&out[0][p * size + sizeof id], &(body->*values)[p * width], row);
    }
    std::vector<char> in;
    PetscCall(exchange_records(comm, size, out, &in));
    std::vector<double>& all = body->*values;
    all.assign(in.size() / size * width, 0);
    for (std::size_t at = 0; at < in.size(); at += size) {
      double id = 0;
      std::memcpy(&id, &in[at], sizeof id);
      std::memcpy(&all[static_cast<std::size_t>(id) * width], &in[at + sizeof id], row);
    }
  }
  body->id.clear();
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
