#pragma once
// Two queues of work on one device, and marks in them that order and time what they hold. Where kernels run
// on the host there is one queue, and a mark has nothing to do.

#include "base/spaces.hpp"

namespace mpm {

/// A place in a queue. To note the time at it as well holds the queue up for a microsecond or two.
template <class Space>
class Mark {
 public:
  enum Kind { untimed, timed };
  explicit Mark(Kind = untimed) {}
  void set(const Space&) {}
  /// What the queue is given from now on waits for this mark.
  void hold(const Space&) const {}
};

/// Seconds from one timed mark to another that have both been passed; 0 where one of them was never set.
template <class Space>
double seconds_between(const Mark<Space>&, const Mark<Space>&) {
  return 0;
}

/// A second queue of the device of another one; its kernels go first.
template <class Space>
class SideQueue {
 public:
  void open(const Space& main) { space_ = main; }
  const Space& space() const { return space_; }

 private:
  Space space_;
};

#ifdef KOKKOS_ENABLE_CUDA
template <>
class Mark<Kokkos::Cuda> {
 public:
  enum Kind { untimed, timed };
  explicit Mark(Kind kind = untimed) : flags_(kind == timed ? cudaEventDefault : cudaEventDisableTiming) {}
  Mark(const Mark&) = delete;
  Mark& operator=(const Mark&) = delete;
  ~Mark() {
    if (event_ != nullptr) (void)cudaEventDestroy(event_);
  }
  void set(const Kokkos::Cuda& space) {
    if (event_ == nullptr) KOKKOS_IMPL_CUDA_SAFE_CALL(cudaEventCreateWithFlags(&event_, flags_));
    KOKKOS_IMPL_CUDA_SAFE_CALL(cudaEventRecord(event_, space.cuda_stream()));
  }
  void hold(const Kokkos::Cuda& space) const {
    if (event_ != nullptr) KOKKOS_IMPL_CUDA_SAFE_CALL(cudaStreamWaitEvent(space.cuda_stream(), event_, 0));
  }
  cudaEvent_t event() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
  unsigned flags_;
};

inline double seconds_between(const Mark<Kokkos::Cuda>& from, const Mark<Kokkos::Cuda>& to) {
  float milliseconds = 0;
  if (from.event() == nullptr || to.event() == nullptr) return 0;
  KOKKOS_IMPL_CUDA_SAFE_CALL(cudaEventElapsedTime(&milliseconds, from.event(), to.event()));
  return milliseconds / 1e3;
}

template <>
class SideQueue<Kokkos::Cuda> {
 public:
  SideQueue() = default;
  SideQueue(const SideQueue&) = delete;
  SideQueue& operator=(const SideQueue&) = delete;
  ~SideQueue() {
    space_ = {};
    if (stream_ != nullptr) (void)cudaStreamDestroy(stream_);
  }
  void open(const Kokkos::Cuda&) {
    int least = 0, greatest = 0;
    KOKKOS_IMPL_CUDA_SAFE_CALL(cudaDeviceGetStreamPriorityRange(&least, &greatest));
    KOKKOS_IMPL_CUDA_SAFE_CALL(cudaStreamCreateWithPriority(&stream_, cudaStreamNonBlocking, greatest));
    space_ = Kokkos::Cuda(stream_);
  }
  const Kokkos::Cuda& space() const { return space_; }

 private:
  cudaStream_t stream_ = nullptr;
  Kokkos::Cuda space_;
};
#endif

}  // namespace mpm
