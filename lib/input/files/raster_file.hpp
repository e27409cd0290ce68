#pragma once
#include <memory>
#include <string>

#include "input/geometry/height_surface.hpp"

namespace mpm {

/// A grid of equal square cells with a value in the middle of each.
struct Raster {
  long columns = 0, rows = 0;
  double x = 0, y = 0, cell = 0;  // m: lower left corner, edge of a cell
  std::vector<double> values;     // row by row from the lowest y; NaN: no data
};

/// Reads an ESRI ASCII grid: ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize, and
/// where it is given NODATA_value, in any order and case; then nrows rows of values, from the highest y down.
/// Returns what the file should have been, as the end of "takes ..."; empty where all is well.
std::string read_raster(const std::string& path, Raster& raster);

/// The surface through the values: linear between the middles of cells, level in the outer half of the
/// outermost ones. Blocks of so many cells along each axis count as one cell, with the mean of their values.
std::shared_ptr<const HeightSurface> surface_of(const Raster& raster, long block = 1);

/// Edge of the blocks [cells of the raster] under a mesh of this spacing [m]: a surface that is far finer
/// than the mesh costs time and changes nothing. 1 where the raster is not far finer.
long block_under_mesh(const Raster& raster, double spacing);

}  // namespace mpm
