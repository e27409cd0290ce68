#include "step/body_ids.hpp"

#include <algorithm>
#include <numeric>

#include "common/collectives.hpp"

namespace mpm {

void BodyIds::assign(const std::vector<BodyParticles>& bodies, int dim) {
  for (const BodyParticles& particles : bodies) {
    first_.push_back(total_);
    total_ += std::max(particles.total, static_cast<long>(particles.position.size()) / dim);
  }
}

PetscErrorCode BodyIds::leave_out(MPI_Comm comm, int dim, std::vector<BodyParticles>* bodies) {
  PetscFunctionBeginUser;
  unused_.assign(bodies->size(), 0);
  const bool leaves = std::any_of(bodies->begin(), bodies->end(),
                                  [](const BodyParticles& body) { return !body.left_out.empty(); });
  for (std::size_t b = 0; b < bodies->size() && leaves; ++b) {
    BodyParticles& body = (*bodies)[b];
    const std::vector<char> out = std::move(body.left_out);
    if (body.id.empty()) {
      body.id.resize(body.position.size() / dim);
      std::iota(body.id.begin(), body.id.end(), static_cast<int>(first_[b]));
    }
    unused_[b] = std::count(out.begin(), out.end(), 1);
    if (unused_[b] == 0) continue;
    remove_rows(out, body);
    remove_rows(out, body.id);
  }
  if (size_of(comm) > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, unused_.data(), static_cast<int>(unused_.size()), MPI_LONG,
                               MPI_SUM, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::size_t BodyIds::body_of(long id) const {
  std::size_t b = first_.size() - 1;
  while (b > 0 && first_[b] > id) --b;
  return b;
}

long BodyIds::particles() const { return given() - std::accumulate(unused_.begin(), unused_.end(), 0L); }

void BodyIds::save(SavedState* saved) const { saved->particles = given(), saved->unused = unused_; }

void BodyIds::restore(const SavedState& saved, bool splits) {
  unused_ = saved.unused;
  if (splits) children_ = std::max(0L, saved.particles - total_);
}

}  // namespace mpm
