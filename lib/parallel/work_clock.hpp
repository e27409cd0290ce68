#pragma once
// The time for which a rank works and the time for which it waits for other ranks; the balance is measured by
// it.

#include <chrono>
#include <ctime>

namespace mpm {

/// Adds up the time between go_on and pause as work, and that between pause and go_on as waiting.
class WorkClock {
 public:
  /// Where kernels run on the host, work is processor time, so that other programs on the machine do not
  /// count. On a device, work is wall time.
  explicit WorkClock(bool device = false) : device_(device) {}

  void go_on() {
    if (paused_) wait_ += wall() - since_wall_;
    paused_ = false;
    since_ = now();
  }
  /// Call it when the kernels before it are done.
  void pause() {
    const double work = now() - since_;
    work_ += work, recent_ += work;
    paused_ = true;
    since_wall_ = wall();
  }
  /// Stops counting until go_on: the time between is neither work nor waiting.
  void stop() {
    pause();
    paused_ = false;
  }
  /// Moves seconds from work to waiting: a device had no work in them.
  void idled(double seconds) { work_ -= seconds, recent_ -= seconds, wait_ += seconds; }
  double work() const { return work_; }
  double wait() const { return wait_; }
  /// Work since the last forget.
  double recent() const { return recent_; }
  void forget() { recent_ = 0; }

  static double wall() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

 private:
  double now() const {
    if (device_) return wall();
    std::timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
  }

  bool device_ = false, paused_ = false;
  double since_ = 0, since_wall_ = 0, work_ = 0, wait_ = 0, recent_ = 0;
};

}  // namespace mpm
