#pragma once
// Rigid bodies and sides of the mesh as bodies that may touch each other.

#include "mpm/config.hpp"
#include "transfer/upload_pairs.hpp"

namespace mpm {

/// The rigid bodies of a configuration, and behind them the sides of the mesh; nothing where no two may meet.
/// Their corners and edges are those of the shapes, and points of them are half a cell apart.
PairInput pair_input(const Config& config);

}  // namespace mpm
