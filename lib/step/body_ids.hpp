#pragma once
// Ids of particles: those of a body follow one another, body by body, and pieces of split particles follow
// all of them.

#include <petscsys.h>

#include <vector>

#include "common/model.hpp"
#include "data/saved_state.hpp"

namespace mpm {

class BodyIds {
 public:
  /// Numbers the particles of all bodies and ranks.
  void assign(const std::vector<BodyParticles>& bodies, int dim);
  /// Leaves particles out that are not in the run; their ids stay theirs. Collective.
  PetscErrorCode leave_out(MPI_Comm comm, int dim, std::vector<BodyParticles>* bodies);
  /// Ids [first, end) of a body at the start.
  long first(std::size_t body) const { return first_[body]; }
  long end(std::size_t body) const { return body + 1 < first_.size() ? first_[body + 1] : total_; }
  /// Body of an id of the start.
  std::size_t body_of(long id) const;
  /// Count of ids at the start, and of all that have been given; of particles in the run. Of all ranks.
  long at_start() const { return total_; }
  long given() const { return total_ + children_; }
  long particles() const;
  /// Gives ids to pieces of split particles.
  void add_children(long count) { children_ += count; }
  void save(SavedState* saved) const;
  /// splits: particles may have been split.
  void restore(const SavedState& saved, bool splits);

 private:
  std::vector<long> first_;        // by body
  std::vector<long> unused_;       // by body: ids that no particle has had
  long total_ = 0, children_ = 0;  // at the start; that splitting has added
};

}  // namespace mpm
