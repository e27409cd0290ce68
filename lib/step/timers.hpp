#pragma once
// Time of each of the paper's functions. Each is a PETSc log event; the seconds of the closing table come
// from a clock around it, in every step where kernels run on the host, in one step of many on a device (which
// must be waited for, and that costs).

#include <petscsys.h>

#include <array>
#include <chrono>

namespace mpm {

/// The functions of a step, by the paper's names.
enum class Function { reset, rigid_to_nodes, soil_to_nodes, nodes, particles, rigids, rebuild };
inline constexpr int k_functions = 7;

const char* name_of(Function f);

class Timers {
 public:
  /// Registers the log events.
  PetscErrorCode create();
  /// Whether the functions called from now on are timed.
  void sample(bool on) { sampling_ = on; }
  bool sampling() const { return sampling_; }

  /// Runs one function; `wait` makes sure that its work is done.
  template <class Work, class Wait>
  PetscErrorCode run(Function f, Work&& work, Wait&& wait) {
    PetscFunctionBeginUser;
    const int n = static_cast<int>(f);
    PetscCall(PetscLogEventBegin(events_[n], 0, 0, 0, 0));
    const auto start = std::chrono::steady_clock::now();
    work();
    ++calls_[n];
    if (sampling_) {
      wait();
      seconds_[n] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      ++sampled_[n];
    }
    PetscCall(PetscLogEventEnd(events_[n], 0, 0, 0, 0));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  long calls(Function f) const { return calls_[static_cast<int>(f)]; }
  /// Seconds of all calls, from those that were timed.
  double seconds(Function f) const {
    const int n = static_cast<int>(f);
    return sampled_[n] == 0 ? 0 : seconds_[n] * (double(calls_[n]) / sampled_[n]);
  }

 private:
  std::array<PetscLogEvent, k_functions> events_{};
  std::array<long, k_functions> calls_{}, sampled_{};
  std::array<double, k_functions> seconds_{};
  bool sampling_ = true;
};

}  // namespace mpm
