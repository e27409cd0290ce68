#pragma once
// Input, log and outcome of a run, which all of its parts use.

#include "common/collectives.hpp"
#include "input/deck/report.hpp"
#include "mpm/simulation.hpp"
#include "output/folder_lock.hpp"
#include "output/log.hpp"

namespace mpm {

struct Job {
  MPI_Comm comm = MPI_COMM_NULL;
  Config config;  // of the present stage
  InputReport report;
  Outcome outcome = Outcome::finished;
  FolderLock lock;  // of the output folder; goes when all is written and closed
  Log log;

  bool goes_well() const { return outcome == Outcome::finished; }
  bool is_first() const { return rank_of(comm) == 0; }
  int ranks() const { return size_of(comm); }
};

}  // namespace mpm
