#pragma once
// Autotune: how fast a strategy is, measured in a few steps.

#include <algorithm>
#include <optional>

#include "step/stepper.hpp"

namespace mpm {

/// Seconds a step, in the best of the first batches of `advance(steps, batch)`, as others may use the machine
/// meanwhile. The very first steps, which load kernels, do not count, nor does a batch in which a device
/// found that it does not hold a launch of many steps. Nothing where no step can be taken.
template <class Advance>
std::optional<double> time_of_steps(const Advance& advance) {
  constexpr long k_first = 2, k_most = 128;
  constexpr double k_enough = 0.02;  // s
  Batch batch;
  if (advance(k_first, &batch) != PETSC_SUCCESS || batch.steps == 0) return std::nullopt;
  std::optional<double> best;
  double all = 0;
  for (long steps = 1; steps <= k_most && all < k_enough; steps *= 2) {
    if (batch.rebuild || !batch.failure.what.empty()) break;
    if (advance(steps, &batch) != PETSC_SUCCESS) return std::nullopt;
    if (batch.steps < steps) continue;
    const double took = batch.seconds / steps;
    all += batch.seconds;
    best = std::min(best.value_or(took), took);
  }
  return best;
}

}  // namespace mpm
