#pragma once
// The log's performance report: where the time went, and how near the functions are to the limit of memory.

#include <optional>
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

/// A figure of every rank: the smallest, the largest and their mean.
struct Spread {
  double least = 0, most = 0, mean = 0;
  double balance() const { return mean > 0 ? most / mean : 1.0; }
};

/// Figures of several ranks since the run began or went on.
struct RankFigures {
  int ranks = 0;
  Spread particles, neighbours, halo_nodes;
  Spread sent;                 // bytes a step
  Spread compute, halo, wait;  // s: kernels; packing and summing ghost sums of nodes; waiting for other ranks
  std::optional<Spread> held;  // s that devices waited for the halo; none where nothing else runs beside it
  std::string halo_path;       // how ghost sums travel, in words
};

/// Performance of a run. After a restart the figures are of the steps since then, but for rebuilds.
struct Performance {
  std::vector<FunctionTime> functions{};
  double wall = 0;                               // s, since the first step
  double stepping = 0;                           // s of it in steps and rebuilds
  long steps = 0, particles = 0;                 // particles of the soil
  long looks = 0;                                // times that the host read the control of the steps
  long rebuilds = 0, shortest = 0, longest = 0;  // of the whole run; steps between rebuilds
  double interval = 0;                           // the mean of them
  std::string strategy, device;                  // the word of -p2g; back end and device
  double memory = 0;                             // bytes on the device, of all ranks
  double bandwidth = 0;                          // bytes/s of the device's copy; 0 if not known
  std::optional<RankFigures> between_ranks{};    // none on one rank

  // Members that only performance.json has, because the log has them elsewhere.
  std::string version, outcome;    // outcome: finished, stopped or failed
  std::string backend, precision;  // words of the options
  std::string processor;           // of rank 0
  int dim = 0, ranks = 1;
  int threads = 1, cores = 1;          // threads of a rank in its kernels; cores that rank 0 may use
  long first_step = 0;                 // from which this part of the run went on
  double time = 0;                     // s, simulated, at its end
  double simulated = 0;                // s, of `time` in this part
  std::optional<double> energy{};      // J, of the processors of all machines; none where it is not counted
  std::optional<double> gpu_energy{};  // J, of the GPUs of all machines; none where it is not counted
};

/// The functions with the times of the report: where these add up to more than the steps took, as on a device
/// that is waited for after each function of a timed step, they are scaled down to it.
std::vector<FunctionTime> functions_within_steps(const Performance& p);

/// Bytes that the functions move in a second of stepping.
double moved_per_second(const Performance& p);

/// Steps times particles in a second of stepping.
double updates_per_second(const Performance& p);

/// Simulated time in a second of wall time; 0 where no time has passed.
double real_time_factor(const Performance& p);

/// The report, in lines: a table of the functions with calls, seconds, share of the wall time, bytes moved,
/// bytes per second and their share of the copy bandwidth; then reads of the host, rebuilds, memory,
/// bandwidth, particle updates per second, simulated time a second, and energies.
std::string format_performance(const Performance& p);

/// Lines of the ranks: smallest and largest of each figure.
std::string format_ranks(const RankFigures& r);

}  // namespace mpm
