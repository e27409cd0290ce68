#pragma once
// Two streams of work on one device, and events that order and time the work in them. Where kernels run on
// the host there is one stream, and an event does nothing.

#include "base/spaces.hpp"

namespace mpm {

/// An event in a stream. A timed event also notes its time, which delays the stream by a microsecond or two.
template <class Space>
class StreamEvent {
 public:
  enum Kind { untimed, timed };
  explicit StreamEvent(Kind = untimed) {}
  /// Records the event behind the work that the stream has now.
  void record(const Space&) {}
  /// Work that the stream gets from now on waits for this event.
  void wait(const Space&) const {}
};

/// Seconds between two timed events that have both completed; 0 where one of them was never recorded.
template <class Space>
double seconds_between(const StreamEvent<Space>&, const StreamEvent<Space>&) {
  return 0;
}

/// A second stream on the device of another stream. Its kernels have priority.
template <class Space>
class SideStream {
 public:
  void open(const Space& main) { space_ = main; }
  const Space& space() const { return space_; }

 private:
  Space space_;
};

#ifdef KOKKOS_ENABLE_CUDA
template <>
class StreamEvent<Kokkos::Cuda> {
 public:
  enum Kind { untimed, timed };
  explicit StreamEvent(Kind kind = untimed)
      : flags_(kind == timed ? cudaEventDefault : cudaEventDisableTiming) {}
  StreamEvent(const StreamEvent&) = delete;
  StreamEvent& operator=(const StreamEvent&) = delete;
  ~StreamEvent() {
    if (event_ != nullptr) (void)cudaEventDestroy(event_);
  }
  void record(const Kokkos::Cuda& space) {
    if (event_ == nullptr) KOKKOS_IMPL_CUDA_SAFE_CALL(cudaEventCreateWithFlags(&event_, flags_));
    KOKKOS_IMPL_CUDA_SAFE_CALL(cudaEventRecord(event_, space.cuda_stream()));
  }
  void wait(const Kokkos::Cuda& space) const {
    if (event_ != nullptr) KOKKOS_IMPL_CUDA_SAFE_CALL(cudaStreamWaitEvent(space.cuda_stream(), event_, 0));
  }
  cudaEvent_t event() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
  unsigned flags_;
};

inline double seconds_between(const StreamEvent<Kokkos::Cuda>& from, const StreamEvent<Kokkos::Cuda>& to) {
  float milliseconds = 0;
  if (from.event() == nullptr || to.event() == nullptr) return 0;
  KOKKOS_IMPL_CUDA_SAFE_CALL(cudaEventElapsedTime(&milliseconds, from.event(), to.event()));
  return milliseconds / 1e3;
}

template <>
class SideStream<Kokkos::Cuda> {
 public:
  SideStream() = default;
  SideStream(const SideStream&) = delete;
  SideStream& operator=(const SideStream&) = delete;
  ~SideStream() {
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
