#pragma once
// A number of each particle that never changes: no step needs it, so it is on no device and does not move
// with its particle. Frames and checkpoints ask for it.

#include <petscsys.h>

#include <vector>

namespace mpm {

/// One number for each id of [0, total), on several ranks in equal blocks of ids.
class KeptById {
 public:
  /// The number of each id, whichever rank gives it. Collective.
  PetscErrorCode keep(MPI_Comm comm, long total, const std::vector<long>& id,
                      const std::vector<double>& number);
  /// The numbers of any ids, in their order. Collective.
  PetscErrorCode look_up(const std::vector<long>& id, std::vector<double>* number) const;

 private:
  int rank_of_block(long id) const { return static_cast<int>(id / block_); }

  MPI_Comm comm_ = MPI_COMM_NULL;
  long block_ = 1, first_ = 0;  // ids of a block; the first one here
  std::vector<double> own_;
};

}  // namespace mpm
