#include "output/frame_queue.hpp"

#include "common/collectives.hpp"

namespace mpm {
namespace {

// A PETSc with its debugging checks keeps one call stack for all threads.
#ifdef PETSC_USE_DEBUG
constexpr std::launch k_launch = std::launch::deferred;
#else
constexpr std::launch k_launch = std::launch::async;
#endif

}  // namespace

void FrameQueue::open(const std::string& folder, Precision precision, const FrameStyle& style,
                      MPI_Comm comm) {
  frames_.open(folder, precision, style, comm);
  in_background_ = size_of(comm) == 1;
  count_ = 0;
}

PetscErrorCode FrameQueue::resume(const Config& config, long count, MPI_Comm comm) {
  PetscFunctionBeginUser;
  PetscCall(frames_.resume(config, count, comm));
  in_background_ = size_of(comm) == 1;
  count_ = frames_.count();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrameQueue::wait() {
  PetscFunctionBeginUser;
  if (!result_.valid()) PetscFunctionReturn(PETSC_SUCCESS);
  const PetscErrorCode failed = result_.get();
  snapshot_ = {};
  if (failed) PetscFunctionReturn(failed);  // it was reported where it failed
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrameQueue::write(Snapshot&& snapshot) {
  PetscFunctionBeginUser;
  PetscCall(wait());
  snapshot_ = std::move(snapshot);
  PetscCallCXX(result_ = std::async(in_background_ ? k_launch : std::launch::deferred,
                                    [this] { return frames_.write(snapshot_); }));
  ++count_;
  if (!in_background_) PetscCall(wait());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrameQueue::settle() {
  PetscFunctionBeginUser;
  PetscCall(wait());
  PetscCall(frames_.settle());
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
