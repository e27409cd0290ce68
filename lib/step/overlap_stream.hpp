#pragma once
// The overlap stream of a device: it moves the rigids and updates the nodes near them while the main stream
// updates the nodes far from rigids.

#include "device/stream_event.hpp"

namespace mpm {

template <class Space>
class OverlapStream {
 public:
  /// The stream. Its work waits for the work that `main` had at the fork, which is now if they are joined.
  const Space& fork(const Space& main) {
    if (forked_) return stream_.space();
    if (!open_) stream_.open(main), open_ = true;
    begun_.record(main);
    begun_.wait(stream_.space());
    forked_ = true;
    return stream_.space();
  }
  /// Work that `main` gets from now on waits for the stream.
  void join(const Space& main) {
    if (!forked_) return;
    forked_ = false;
    done_.record(stream_.space());
    done_.wait(main);
  }

 private:
  SideStream<Space> stream_;
  StreamEvent<Space> begun_, done_;
  bool open_ = false, forked_ = false;
};

}  // namespace mpm
