#pragma once
// Energy counters of a machine's processors.

#include <string>
#include <vector>

namespace mpm {

/// Energy that the processors of this machine and their memory have taken, by the counters of the kernel's
/// powercap interface (RAPL of Intel and AMD), with all that runs on them. Most machines let only root read
/// these; then nothing is found.
class EnergyMeter {
 public:
  explicit EnergyMeter(const std::string& folder = "/sys/class/powercap");

  /// Whether there are counters, and this process may read them.
  bool found() const { return !counters_.empty(); }
  /// Adds the advance of the counters since the last call. They begin anew after some 200 kJ: more than one
  /// such beginning between two calls is not seen.
  void read();
  /// J, from the start to the last call of read().
  double joules() const { return joules_; }

 private:
  struct Counter {
    std::string file;
    double last = 0, range = 0;  // microjoules
  };
  std::vector<Counter> counters_;
  double joules_ = 0;
};

}  // namespace mpm
