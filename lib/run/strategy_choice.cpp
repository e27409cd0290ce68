#include "run/strategy_choice.hpp"

#include <algorithm>

namespace mpm {
namespace {

/// The least of all rounds of all [s]; 0 of none.
double fastest_of(const std::vector<AutotuneTimes>& candidates) {
  double fastest = 0;
  for (const AutotuneTimes& candidate : candidates)
    if (const double least = least_of(candidate.seconds); least > 0 && (fastest == 0 || least < fastest))
      fastest = least;
  return fastest;
}

}  // namespace

double least_of(const std::vector<double>& seconds) {
  return seconds.empty() ? 0 : *std::min_element(seconds.begin(), seconds.end());
}

double median_of(std::vector<double> seconds) {
  if (seconds.empty()) return 0;
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  return *middle;
}

bool is_beaten(const AutotuneTimes& candidate, const std::vector<AutotuneTimes>& candidates) {
  return least_of(candidate.seconds) > k_beaten * fastest_of(candidates);
}

StrategyChoice choose_by_times(const std::vector<AutotuneTimes>& candidates, double load) {
  const double fastest = fastest_of(candidates);
  const auto chosen = std::find_if(candidates.begin(), candidates.end(), [&](const AutotuneTimes& candidate) {
    return !candidate.seconds.empty() && least_of(candidate.seconds) <= (1 + k_tie) * fastest;
  });
  if (chosen == candidates.end()) return {};
  StrategyChoice choice{chosen->strategy, load <= k_busy};
  const double typical = median_of(chosen->seconds);
  for (auto other = candidates.begin(); other != candidates.end(); ++other) {
    const double least = least_of(other->seconds);
    if (other == chosen || least == 0) continue;
    const bool before = other < chosen;  // such a one is taken unless it is slower by more than the tie
    choice.clear = choice.clear && (before ? (1 + k_tie) * typical < least : typical <= (1 + k_tie) * least);
  }
  return choice;
}

}  // namespace mpm
