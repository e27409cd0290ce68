#pragma once
// history.csv: one row of scalars each -history_interval.

#include <petscsys.h>

#include <cstdint>
#include <string>

#include "common/snapshot.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// The header line, without a line end: step,time,dt,wall_time, then the columns of each body, each rigid and
/// each side of the mesh that is not free.
std::string history_header(const Config& config);

/// The energy balance as a line for the log.
std::string format_energy(const EnergyRow& energy);

/// A row in the same order, without a line end; enough digits to read the same numbers back.
std::string format_history_row(const HistoryRow& row, const Config& config);

/// The first bytes of a history.csv, as all rows of a run up to some step.
struct HistoryMark {
  long bytes = 0;         // with the header line
  std::uint32_t crc = 0;  // of them

  bool operator==(const HistoryMark&) const = default;
};

/// Mark of the written part of a file, of at most `bytes`; its text goes to `text`, unless that is null. All
/// zero where it cannot be read.
HistoryMark mark_of(const std::string& path, long bytes, std::string* text);

/// The open file. Rows are whole: each is one write, and one that does not fit the disk is taken back.
class History {
 public:
  History() = default;
  History(const History&) = delete;
  History& operator=(const History&) = delete;
  ~History();

  /// Starts OUTPUT/history.csv with its header, or with the header and rows of an earlier part of the run.
  PetscErrorCode open(const Config& config, const std::string& rows = "");
  /// Appends one row. An error (full disk) names the file, and what stands there stays whole.
  PetscErrorCode write(const HistoryRow& row);
  /// Brings the rows written so far to the disk, and marks their end.
  PetscErrorCode settle(HistoryMark* mark) const;
  PetscErrorCode close();

 private:
  std::string path_;
  Config config_;
  int descriptor_ = -1;
  HistoryMark mark_;
};

}  // namespace mpm
