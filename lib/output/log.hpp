#pragma once
// The one log of a run: what the terminal shows goes to mpm.log too.

#include <petscsys.h>

#include <cstdio>
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// How far the run is; the numbers are of all ranks.
struct ProgressState {
  long step = 0;
  double time = 0, start = 0, end = 0;  // s, simulated; start is not 0 after a restart
  double wall = 0;                      // s since the first step
  double particle_updates = 0;          // particles times steps since the first step
};

std::string processor_name();                 // of this machine
int usable_cores();                           // that this process may use
std::string format_duration(double seconds);  // "42 s", "3 min 05 s", "2 h 07 min"
std::string format_rate(double per_second);   // "12.3 M/s"
std::string format_progress(
    const ProgressState& s);  // "step 1200  t = 0.072 s  3.6 %  12.3 M/s  2 min 05 s left"

/// Program, date, machine (host, processor, cores, ranks) and versions of the libraries (the function finds
/// those of PETSc, MPI and HDF5; the caller gives the version of Kokkos and the device's name). Collective on
/// nothing; one rank calls it.
std::string format_header(const std::string& version, const std::string& kokkos_version,
                          const std::string& device, int ranks);

/// Lines to the terminal and to the file, from rank 0 of the communicator; other ranks are silent.
class Log {
 public:
  Log() = default;
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  ~Log();

  /// Before open: which rank speaks. Lines before open go to the terminal and are kept for the file.
  PetscErrorCode start(MPI_Comm comm, Progress progress);
  /// Starts OUTPUT/mpm.log, or goes on with it.
  PetscErrorCode open(const std::string& folder, bool goes_on = false);
  /// Text of one or more lines; the last line end may be left out.
  PetscErrorCode line(const std::string& text);
  /// Writes a line by a format as of printf.
  PetscErrorCode print(const char* format, ...) __attribute__((format(printf, 2, 3)));
  /// Text of a line that says why the run failed: to stderr instead of stdout, and to the file.
  PetscErrorCode error(const std::string& text);
  /// Call it after every batch of steps: it rewrites the live line a few times a second, or prints each 10 %.
  PetscErrorCode progress(const ProgressState& state);
  PetscErrorCode close();

 private:
  PetscErrorCode say(const std::string& text, std::FILE* terminal);
  PetscErrorCode write_file(const std::string& text);
  void clear_live_line();

  std::string path_, pending_;
  int descriptor_ = -1;
  bool speaks_ = false, lines_ = true, live_ = false, live_line_shown_ = false;
  int tenths_ = 0;         // last tenth of the run that was reported
  double last_live_ = -1;  // s of wall time at the last live line
};

}  // namespace mpm
