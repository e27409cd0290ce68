#pragma once
// Which strategy `-p2g auto` takes, from the times that trials measured: numbers only, no clock.

#include <vector>

#include "base/choices.hpp"

namespace mpm {

/// Seconds a step that rounds of trials found of one strategy. Empty where it could make no step.
struct AutotuneTimes {
  P2G strategy;
  std::vector<double> seconds;  // s, one a round
};

struct StrategyChoice {
  P2G strategy = P2G::automatic;  // automatic where none could make a step
  bool clear = false;             // whether another measurement would say the same, so that it may be kept
};

/// The part by which a strategy must be faster than one before it in the list, to be taken in its place.
constexpr double k_tie = 0.05;
/// A strategy that takes so many times the fastest is not tried again.
constexpr double k_beaten = 3;
/// Processes that want to run per core, above which times say more of the others than of us.
constexpr double k_busy = 1.25;

/// The first of the list whose time is within `k_tie` of the fastest. Other processes only ever add to a
/// time, so that a strategy's figure is its fastest round. The choice is clear where the typical round (the
/// median) of the one taken decides alike, and the machine's load [runnable processes per core] is not above
/// `k_busy`.
StrategyChoice choose_by_times(const std::vector<AutotuneTimes>& candidates, double load);

/// Is a strategy so much slower than the fastest that more rounds of it would not change the choice?
bool is_beaten(const AutotuneTimes& candidate, const std::vector<AutotuneTimes>& candidates);

/// The fastest of some rounds [s] and their median; 0 of none.
double least_of(const std::vector<double>& seconds);
double median_of(std::vector<double> seconds);

}  // namespace mpm
