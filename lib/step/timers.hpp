#pragma once
// Time of each of the paper's functions. Each is a PETSc log event; the seconds of the closing table come
// from a clock around it, in every step where kernels run on the host, in one step of many on a device (which
// must be waited for, and that costs).

#include <petscsys.h>

#include <array>
#include <chrono>

namespace mpm {

/// The functions of a step, by the paper's names; all functions of the persistent steps of a small problem
/// together; and the works of an energy balance.
enum class StepPhase {
  reset,
  rigid_to_nodes,
  soil_to_nodes,
  nodes,
  particles,
  rigids,
  persistent,
  energy,
  rebuild
};
inline constexpr int k_functions = 9;

const char* name_of(StepPhase f);

class Timers {
 public:
  /// Registers the log events.
  PetscErrorCode create();
  /// Whether the functions called from now on are timed.
  void sample(bool on) { sampling_ = on; }
  bool sampling() const { return sampling_; }

  /// Runs one function; `wait` makes sure that its work is done.
  template <class Work, class Wait>
  PetscErrorCode run(StepPhase f, Work&& work, Wait&& wait) {
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

  /// Runs a function as many times as `work` returns, at most `most`. Where these are many, so that it costs
  /// little to wait for what was before and for them, they are timed, ever again after a thousand.
  template <class Work, class Wait>
  PetscErrorCode run_many(StepPhase f, long most, Work&& work, Wait&& wait) {
    PetscFunctionBeginUser;
    constexpr long k_many = 20, k_apart = 1000;
    const int n = static_cast<int>(f);
    const bool timed = most >= k_many && calls_[n] >= next_many_;
    PetscCall(PetscLogEventBegin(events_[n], 0, 0, 0, 0));
    if (timed) wait();
    const auto start = std::chrono::steady_clock::now();
    const long count = work();
    calls_[n] += count;
    if (timed) {
      wait();
      seconds_[n] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      sampled_[n] += count;
      next_many_ = calls_[n] + k_apart;
    }
    PetscCall(PetscLogEventEnd(events_[n], 0, 0, 0, 0));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  long calls(StepPhase f) const { return calls_[static_cast<int>(f)]; }
  /// Seconds of all calls, from those that were timed.
  double seconds(StepPhase f) const {
    const int n = static_cast<int>(f);
    return sampled_[n] == 0 ? 0 : seconds_[n] * (double(calls_[n]) / sampled_[n]);
  }

 private:
  std::array<PetscLogEvent, k_functions> events_{};
  std::array<long, k_functions> calls_{}, sampled_{};
  std::array<double, k_functions> seconds_{};
  bool sampling_ = true;
  long next_many_ = 0;  // call of run_many from which on it is timed again
};

}  // namespace mpm
