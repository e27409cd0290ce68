#pragma once
// What the log tells once: soil that is no longer as the rest of it.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/snapshot.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Looks at the rows of the history for what happens the first time in a run.
class Notices {
 public:
  /// A line for each thing that has happened since the last row and was not told before, with advice.
  std::vector<std::string> report(const HistoryRow& row, const Config& config);

  /// A stage may place particles.
  void begin_stage() { particles_.clear(); }

 private:
  void report_soil(const HistoryRow& row, const Config& config, std::vector<std::string>* lines);

  std::set<std::string> told_;             // what happened, to which body
  std::map<std::string, long> particles_;  // of each body, when its first row was seen
  double passed_ = 0;                      // J, the largest energy or work so far
};

}  // namespace mpm
