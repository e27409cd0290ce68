#pragma once
// Whether a run fits into memory, before anything is made.

#include <mpi.h>

#include <string>

#include "mpm/config.hpp"

namespace mpm {

/// Estimates from sizes alone, right to about a tenth.
struct MemoryNeed {
  double particles = 0;       // of the bodies: of their lattices, and listed in files
  double rigids = 0;          // particles of the rigids, which every rank has all
  double samples = 0;         // bytes of the rigids' sampled surfaces
  double patches = 0;         // of the mesh, with the ring outside
  double device = 0;          // bytes, where the kernels run
  double nodes = 0;           // bytes of that which are not the particles'
  double host = 0;            // bytes beside, while particles are made and frames are written
  double all_ranks = 0;       // bytes of the device that each rank takes, whatever their number
  double all_ranks_host = 0;  // likewise of the host
};
MemoryNeed memory_need(const Config& config);

/// Bytes that are free where a backend's kernels run; 0 where the system does not report them.
double free_memory(Backend backend);

/// Why a run cannot fit, as a line for the user; empty if it can.
/// On several ranks it is that of the rank that asks; its node holds others too. Collective.
std::string memory_fault(const Config& config, MPI_Comm comm = MPI_COMM_SELF);

}  // namespace mpm
