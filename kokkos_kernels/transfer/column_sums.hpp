#pragma once
// Columns of soil over a grid, for rasters of depth and speed.

#include "data/core.hpp"
#include "data/probe_data.hpp"

namespace mpm {

/// The columns of this rank's particles, [column][1 + Dim] as in ColumnGrid; x is the fastest. A particle
/// is spread over the columns that its domain covers. `area` [m2] of a column is that of its cell: in 2D its
/// edge times 1 m, of bodies of revolution that of its ring.
template <class Space, class T, int Dim>
std::vector<long> column_sums(const Core<Space, T, Dim>& s, const ColumnGrid& grid);

}  // namespace mpm
