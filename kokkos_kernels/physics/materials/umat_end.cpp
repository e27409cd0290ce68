#include "physics/materials/umat_end.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "physics/materials/umat_library.hpp"

namespace mpm {
namespace {

thread_local RunningUmat running;  // exit runs its handlers on the thread that called it

/// Ends the process without the handlers of exit, which would call this again.
[[noreturn]] void end_process(int status) {
  for (;;) syscall(SYS_exit_group, status);
}

/// Reports that the code of the user ended the program, and ends it. Does nothing at any other end.
void end_with_line() {
  const RunningUmat was = running;
  if (was.library == nullptr) return;
  running = {};
  std::fflush(stdout);
  const UmatCall* call = was.call;
  constexpr int k_bad_input = 2, k_failed = 3;
  if (call == nullptr || call->at_start) {
    std::fprintf(
        stderr,
        "mpm: -%s_library: given \"%s\", takes a UMAT that returns to its caller; it ended the program "
        "(exit, or STOP in Fortran) %s\n",
        was.library->name.c_str(), was.library->path.c_str(),
        call == nullptr ? "as it was loaded" : "when it was called at the start");
    end_process(k_bad_input);
  }
  char place[120];
  const double* x = call->position;
  if (was.library->dim == 2)
    std::snprintf(place, sizeof place, "(%.9g, %.9g)", x[0], x[1]);
  else
    std::snprintf(place, sizeof place, "(%.9g, %.9g, %.9g)", x[0], x[1], x[2]);
  std::fprintf(
      stderr,
      "mpm: step %d, time %.9g s: the UMAT of material %s ended the program (exit, or STOP in Fortran) "
      "at particle %d of the run, at %s m; XIT or PNEWDT below 1 ends a run with its results whole\n",
      was.step, call->time, was.library->name.c_str(), call->id + 1, place);
  end_process(k_failed);
}

}  // namespace

WatchedUmat::WatchedUmat(const RunningUmat& now) : before_(running) {
  [[maybe_unused]] static const bool registered = [] {
    return std::atexit(end_with_line) == 0 && std::at_quick_exit(end_with_line) == 0;
  }();
  running = now;
}

WatchedUmat::~WatchedUmat() { running = before_; }

}  // namespace mpm

#ifdef __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MPM_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MPM_SANITIZED
#endif
#ifndef MPM_SANITIZED
/// In place of the C library's function, which runs no handlers: umat_symbols.txt exports it to libraries.
/// The sanitizers have their own.
extern "C" [[noreturn]] void _exit(int status) {
  mpm::end_with_line();
  mpm::end_process(status);
}
#endif
