#pragma once
// Which rank owns which patch. The table is total: a patch without particles has an owner too, for those that
// come to it.

#include <petscsys.h>

#include "mesh/patch_grid.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Load of every patch of the whole grid: particles, or seconds.
using Loads = std::vector<double>;

/// Largest over mean of the ranks' loads; 1 where there is none.
double imbalance_of(const std::vector<double>& by_rank);
std::vector<double> loads_of(const Owners& owners, const Loads& loads, int ranks);

/// Cuts the graph of the patches that have a load into parts of about the same load with few shared nodes
/// between them, by METIS. Parts are numbered so that as much as possible stays with its owner of before,
/// where `before` is not empty. A patch without load goes to the part of the nearest one that has some.
Owners cut_graph(const PatchGrid& grid, const Loads& loads, int ranks, const Owners& before);

/// Cuts the graph on rank 0 and gives every rank of comm the result. Collective.
PetscErrorCode cut_graph(MPI_Comm comm, const PatchGrid& grid, const Loads& loads, const Owners& before,
                         Owners* owners);

}  // namespace mpm
