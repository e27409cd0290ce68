#include "output/frame_queue.hpp"

namespace mpm {
namespace {

// A PETSc with its debugging checks keeps one call stack for all threads.
#ifdef PETSC_USE_DEBUG
constexpr std::launch k_launch = std::launch::deferred;
#else
constexpr std::launch k_launch = std::launch::async;
#endif

}  // namespace

void FrameQueue::open(const std::string& folder, Precision precision, const FrameStyle& style) {
  frames_.open(folder, precision, style);
  count_ = 0;
}

PetscErrorCode FrameQueue::resume(const Config& config, long count) {
  PetscFunctionBeginUser;
  PetscCall(frames_.resume(config, count));
  count_ = frames_.count();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrameQueue::wait() {
  PetscFunctionBeginUser;
  if (!result_.valid()) PetscFunctionReturn(PETSC_SUCCESS);
  const PetscErrorCode failed = result_.get();
  snapshot_ = {};
  if (failed) PetscFunctionReturn(failed);  // it has been told where it failed
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrameQueue::write(Snapshot&& snapshot) {
  PetscFunctionBeginUser;
  PetscCall(wait());
  snapshot_ = std::move(snapshot);
  PetscCallCXX(result_ = std::async(k_launch, [this] { return frames_.write(snapshot_); }));
  ++count_;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FrameQueue::settle() {
  PetscFunctionBeginUser;
  PetscCall(wait());
  PetscCall(frames_.settle());
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
