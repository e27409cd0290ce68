#include "output/log.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>

#include "common/text.hpp"
#include "output/files.hpp"

namespace mpm {
namespace {

std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  MPI_Get_library_version(text, &length);
  const std::string version(text);
  return version.substr(0, version.find_first_of(",\n"));
}

/// Share of the simulated time that is done, 0 to 1.
double share_done(const ProgressState& s) {
  return s.end > s.start ? std::clamp((s.time - s.start) / (s.end - s.start), 0.0, 1.0) : 1.0;
}

}  // namespace

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.find(':') + 2, line.size()));
  return "unknown processor";
}

int usable_cores() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

std::string format_duration(double seconds) {
  const long s = std::isfinite(seconds) && seconds > 0 ? std::lround(std::min(seconds, 1e12)) : 0;
  if (s < 60) return formatted("%ld s", s);
  if (s < 3600) return formatted("%ld min %02ld s", s / 60, s % 60);
  if (s < 86400) return formatted("%ld h %02ld min", s / 3600, s % 3600 / 60);
  return formatted("%ld d %02ld h", s / 86400, s % 86400 / 3600);
}

std::string format_rate(double per_second) {
  if (per_second >= 999.95e6) return formatted("%.2f G/s", per_second / 1e9);
  if (per_second >= 999.95e3) return formatted("%.1f M/s", per_second / 1e6);
  return formatted("%.1f k/s", per_second / 1e3);
}

std::string format_progress(const ProgressState& s) {
  const double done = share_done(s);
  std::string text = formatted("step %ld  t = %.6g s  %.1f %%", s.step, s.time, 100 * done);
  if (s.wall <= 0) return text;
  text += "  " + format_rate(s.particle_updates / s.wall) + " particle updates";
  if (done >= 1) return text + "  in " + format_duration(s.wall);
  return done > 0 ? text + "  " + format_duration(s.wall * (1 - done) / done) + " left" : text;
}

std::string format_header(const std::string& version, const std::string& kokkos_version,
                          const std::string& device, int ranks) {
  char host[256] = "unknown host", date[64] = "";
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S %z", &local);
  gethostname(host, sizeof host - 1);
  PetscInt major = 0, minor = 0, subminor = 0;
  (void)PetscGetVersionNumber(&major, &minor, &subminor, nullptr);
  unsigned h5[3] = {0, 0, 0};
  H5get_libversion(&h5[0], &h5[1], &h5[2]);
  std::string text = "mpm " + version + "  " + date + "\n";
  text += formatted("  machine    %s, %s, %d cores, %d rank%s\n", host, processor_name().c_str(),
                    usable_cores(), ranks, ranks == 1 ? "" : "s");
  text += "  device     " + device + "\n";
  text += formatted("  libraries  PETSc %d.%d.%d, Kokkos %s, %s, HDF5 %u.%u.%u\n", int(major), int(minor),
                    int(subminor), kokkos_version.c_str(), mpi_version().c_str(), h5[0], h5[1], h5[2]);
  return text;
}

Log::~Log() {
  if (live_line_shown_) std::fputs("\n", stdout);
  if (descriptor_ >= 0) ::close(descriptor_);
}

PetscErrorCode Log::start(MPI_Comm comm, Progress progress) {
  PetscMPIInt rank = 0;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  speaks_ = rank == 0;
  lines_ = progress != Progress::off;
  live_ = progress == Progress::on || (progress == Progress::automatic && isatty(STDOUT_FILENO));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Log::open(const std::string& folder, bool goes_on) {
  PetscFunctionBeginUser;
  if (!speaks_) PetscFunctionReturn(PETSC_SUCCESS);
  path_ = folder + "/mpm.log";
  descriptor_ =
      ::open(path_.c_str(), O_WRONLY | O_CREAT | (goes_on ? 0 : O_TRUNC) | O_APPEND | O_CLOEXEC, 0666);
  PetscCheck(descriptor_ >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", path_.c_str(),
             std::strerror(errno));
  PetscCall(write_all(descriptor_, pending_, path_));
  pending_.clear();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Log::write_file(const std::string& text) {
  PetscFunctionBeginUser;
  if (descriptor_ >= 0)
    PetscCall(write_all(descriptor_, text, path_));
  else
    pending_ += text;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void Log::clear_live_line() {
  if (live_line_shown_) std::fputs("\r\033[K", stdout);
  live_line_shown_ = false;
}

PetscErrorCode Log::say(const std::string& text, std::FILE* terminal) {
  PetscFunctionBeginUser;
  if (!speaks_) PetscFunctionReturn(PETSC_SUCCESS);
  const std::string whole = text.ends_with('\n') ? text : text + "\n";
  clear_live_line();
  std::fflush(stdout);
  std::fputs(whole.c_str(), terminal);
  std::fflush(terminal);
  PetscCall(write_file(whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Log::line(const std::string& text) {
  PetscFunctionBeginUser;
  PetscCall(say(text, stdout));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Log::error(const std::string& text) {
  PetscFunctionBeginUser;
  PetscCall(say(text, stderr));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Log::print(const char* format, ...) {
  PetscFunctionBeginUser;
  char buffer[4096];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  PetscCall(line(buffer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Log::progress(const ProgressState& state) {
  constexpr double k_live_interval = 0.25;  // s
  PetscFunctionBeginUser;
  if (!speaks_ || !lines_) PetscFunctionReturn(PETSC_SUCCESS);
  const int tenths = static_cast<int>(10 * share_done(state) + 1e-9);
  if (tenths > tenths_) {
    tenths_ = tenths;
    // A live line shows this already: only the file gets it, but for the last, which stays on the terminal.
    if (live_ && tenths < 10)
      PetscCall(write_file(format_progress(state) + "\n"));
    else
      PetscCall(line(format_progress(state)));
  } else if (live_ && state.wall - last_live_ >= k_live_interval) {
    last_live_ = state.wall;
    // Without line wrap, so that a narrow terminal cuts the line and the next one still overwrites it.
    std::fputs(("\r\033[?7l" + format_progress(state) + "\033[K\033[?7h").c_str(), stdout);
    std::fflush(stdout);
    live_line_shown_ = true;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Log::close() {
  PetscFunctionBeginUser;
  if (speaks_) clear_live_line();
  PetscCall(close_file(&descriptor_, path_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
