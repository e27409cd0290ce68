#pragma once
// history.csv: one row of scalars each -history_interval.

#include <petscsys.h>

#include <string>

#include "mpm/config.hpp"
#include "output/snapshot.hpp"

namespace mpm {

/// The header line, without a line end: step,time,dt,wall_time, then the columns of each body and each rigid.
std::string history_header(const Config& config);

/// A row in the same order, without a line end; enough digits to read the same numbers back.
std::string format_history_row(const HistoryRow& row, int dim);

/// The open file. Rows are whole: each is one write, and one that does not fit the disk is taken back.
class History {
 public:
  History() = default;
  History(const History&) = delete;
  History& operator=(const History&) = delete;
  ~History();

  /// Starts OUTPUT/history.csv with its header.
  PetscErrorCode open(const Config& config);
  /// Appends one row. An error (full disk) names the file, and what stands there stays whole.
  PetscErrorCode write(const HistoryRow& row);
  PetscErrorCode close();

 private:
  std::string path_;
  int dim_ = 2;
  int descriptor_ = -1;
};

}  // namespace mpm
