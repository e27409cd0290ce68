#pragma once
// The log's performance report: where the time went, and how near the functions are to the limit of memory.

#include <string>
#include <vector>

namespace mpm {

/// Time of one of the step's functions on the slowest rank.
struct FunctionTime {
  std::string name;
  long calls = 0;
  double seconds = 0;
  double bytes = 0;  // that all calls must move to and from memory; 0 if not known
};

/// What a run came to.
struct Performance {
  std::vector<FunctionTime> functions;
  double wall = 0;                               // s, since the first step
  double stepping = 0;                           // s of it in steps and rebuilds
  long steps = 0, particles = 0;                 // particles of the soil
  long looks = 0;                                // of the host at what the steps came to
  long rebuilds = 0, shortest = 0, longest = 0;  // steps between rebuilds
  double interval = 0;                           // the mean of them
  std::string strategy, device;                  // the word of -p2g; back end and device
  double memory = 0;                             // bytes on the device
  double bandwidth = 0;                          // bytes/s of the device's copy; 0 if not known
};

/// The report, in lines (where the functions' times add up to more than the steps took, as on a device that
/// is waited for after each function of a timed step, they are scaled down to it): a table of the functions
/// with calls, seconds, share of the wall time, bytes moved, bytes per second and their share of the copy
/// bandwidth; then looks of the host, rebuilds, memory, bandwidth and particle updates per second.
std::string format_performance(const Performance& p);

}  // namespace mpm
