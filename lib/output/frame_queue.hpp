#pragma once
// Frames written on a thread beside the run, so that steps go on while a frame is put together, compressed
// and brought to the disk. One frame is on its way at a time; nothing else of the run may call HDF5
// meanwhile, so who does settles first. Several ranks write a frame at once: MPI is not for two threads here.

#include <future>

#include "output/frames.hpp"

namespace mpm {

class FrameQueue {
 public:
  /// As Frames has them.
  void open(const std::string& folder, Precision precision, const FrameStyle& style,
            MPI_Comm comm = PETSC_COMM_SELF);
  PetscErrorCode resume(const Config& config, long count, MPI_Comm comm = PETSC_COMM_SELF);
  /// Takes a frame.
  PetscErrorCode write(Snapshot&& snapshot);
  /// Waits until the frame on its way is written, and lets its memory go. A failure of this frame is reported
  /// now.
  PetscErrorCode wait();
  /// Waits, and brings all frames to the disk.
  PetscErrorCode settle();
  /// Frames taken.
  long count() const { return count_; }

 private:
  Frames frames_;
  bool in_background_ = true;  // frames are written while the run goes on
  Snapshot snapshot_;          // on its way
  long count_ = 0;
  std::future<PetscErrorCode> result_;  // last: it waits for its thread before the others go
};

}  // namespace mpm
