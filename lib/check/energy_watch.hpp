#pragma once
// Whether a run makes energy from nothing, which a time step that is not stable does.

#include <string>

#include "common/snapshot.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Checks the energy in the rows of the history. Soil has the kinetic and elastic energy that it began with,
/// and what gravity, water and the rigids do on it; more kinetic energy than that by half of what has ever
/// passed is a fault of the computation.
class EnergyWatch {
 public:
  /// Begins anew with the soil as it is now. wave_energy [J]: what the soil would have at the speed of its
  /// fastest wave; less than 1e-10 of it is round-off.
  void begin(const HistoryRow& row, double wave_energy);
  /// Fault of a row; empty if there is none.
  std::string check(const HistoryRow& row, const Config& config);

 private:
  void add_work(const HistoryRow& row, const Config& config);

  HistoryRow last_;
  double available_ = 0, passed_ = 0, least_ = 0;  // J
};

}  // namespace mpm
