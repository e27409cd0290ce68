#pragma once
// Notices that the log prints once: soil that is no longer as the rest of it.

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "check/rigid_places.hpp"
#include "common/snapshot.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Searches the rows of the history for events that happen the first time in a run.
class Notices {
 public:
  /// A line for each event since the last row that was not reported before, with advice. `rigid_zero`: from
  /// where the row counts displacements of rigids [m], three numbers each, or empty.
  std::vector<std::string> report(const HistoryRow& row, const Config& config,
                                  const std::vector<double>& rigid_zero = {});

  /// A stage may place particles and rigids.
  void begin_stage() { particles_.clear(), places_.reset(); }

 private:
  void report_rigids(const HistoryRow& row, const Config& config, const std::vector<double>& rigid_zero,
                     std::vector<std::string>* lines);
  void report_soil(const HistoryRow& row, const Config& config, std::vector<std::string>* lines);

  std::set<std::string> logged_;           // what happened, to which body
  std::map<std::string, long> particles_;  // of each body, when its first row was seen
  std::unique_ptr<RigidPlaces> places_;    // where there are several rigids
  std::set<std::pair<int, int>> parts_;    // pairs of rigids that had space in common in their first row
  double passed_ = 0;                      // J, the largest energy or work so far
};

}  // namespace mpm
