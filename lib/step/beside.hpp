#pragma once
// A second queue of the device for the movement of the rigids and what nodes near them wait for, while those
// far from them are updated.

#include "device/queues.hpp"

namespace mpm {

template <class Space>
class Beside {
 public:
  /// The queue, behind what `main` had been given when they parted: now, if they had not yet.
  const Space& fork(const Space& main) {
    if (apart_) return queue_.space();
    if (!open_) queue_.open(main), open_ = true;
    begun_.set(main);
    begun_.hold(queue_.space());
    apart_ = true;
    return queue_.space();
  }
  /// What `main` is given from now on waits for the queue.
  void join(const Space& main) {
    if (!apart_) return;
    apart_ = false;
    done_.set(queue_.space());
    done_.hold(main);
  }

 private:
  SideQueue<Space> queue_;
  Mark<Space> begun_, done_;
  bool open_ = false, apart_ = false;
};

}  // namespace mpm
