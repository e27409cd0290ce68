#pragma once
// A second queue of the device for what nodes near rigids wait for, while those far from them are updated.

#include "queues.hpp"

namespace mpm {

template <class Space>
class Beside {
 public:
  /// The queue, which begins where `main` is.
  const Space& fork(const Space& main) {
    if (!open_) queue_.open(main), open_ = true;
    begun_.set(main);
    begun_.hold(queue_.space());
    return queue_.space();
  }
  /// What `main` is given from now on waits for the queue.
  void join(const Space& main) {
    done_.set(queue_.space());
    done_.hold(main);
  }

 private:
  SideQueue<Space> queue_;
  Mark<Space> begun_, done_;
  bool open_ = false;
};

}  // namespace mpm
