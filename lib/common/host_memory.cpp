#include "common/host_memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

namespace mpm {

/// Bytes that a limit on the process's memory (ulimit -v) leaves; infinite where there is none.
static double free_in_process() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return HUGE_VAL;
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return std::max(double(limit.rlim_cur) - pages * double(sysconf(_SC_PAGESIZE)), 1.0);
}

double free_host_memory() {
  std::ifstream file("/proc/meminfo");
  for (std::string name, rest; file >> name && std::getline(file, rest);)
    if (name == "MemAvailable:") return std::min(1024 * std::stod(rest), free_in_process());
  return 0;
}

}  // namespace mpm
