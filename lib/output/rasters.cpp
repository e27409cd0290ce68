#include "output/rasters.hpp"

#include <algorithm>
#include <cmath>

#include "common/text.hpp"
#include "output/files.hpp"

namespace mpm {
namespace {

constexpr const char* k_no_data = "-9999";

/// A raster as an ESRI ASCII grid, from the highest y down.
std::string ascii_grid(const ColumnGrid& grid, const Config& config, const std::vector<double>& values) {
  const Vec3& lower = config.mesh.lower;
  const Vec3& origin = config.rasters.origin;
  std::string text = formatted("ncols %d\nnrows %d\n", grid.cells[0], grid.cells[1]) + "xllcorner " +
                     text_of(lower[0] + origin[0]) + "\nyllcorner " + text_of(lower[1] + origin[1]) +
                     "\ncellsize " + text_of(grid.cell) + "\nNODATA_value " + k_no_data + "\n";
  for (int j = grid.cells[1] - 1; j >= 0; --j)
    for (int i = 0; i < grid.cells[0]; ++i) {
      const double value = values[static_cast<std::size_t>(j) * grid.cells[0] + i];
      text +=
          (value == k_never ? k_no_data : formatted("%.9g", value)) + (i + 1 < grid.cells[0] ? " " : "\n");
    }
  return text;
}

}  // namespace

ColumnGrid column_grid(const Config& config) {
  ColumnGrid grid;
  grid.cell = config.rasters.spacing, grid.cells = {1, 1}, grid.bodies = config.rasters.bodies;
  for (int d = 0; d + 1 < config.dim; ++d)
    grid.cells[d] =
        static_cast<int>(std::ceil((config.mesh.upper[d] - config.mesh.lower[d]) / grid.cell - 1e-9));
  return grid;
}

RasterBytes raster_bytes(const Config& config) {
  if (!config.rasters.on) return {};
  const double columns = double(column_grid(config).count()), sums = (1.0 + config.dim) * sizeof(long);
  constexpr double k_kept = 4 * sizeof(double), k_copies = 2;  // of the sums, while they are brought together
  return {columns * sums, columns * (k_kept + k_copies * sums)};
}

void Rasters::begin(const Config& config) {
  const auto count = static_cast<std::size_t>(column_grid(config).count());
  most_depth.assign(count, 0), most_speed.assign(count, 0), arrival.assign(count, k_never),
      depth.assign(count, 0);
}

void Rasters::look(const Config& config, const std::vector<long>& sums) {
  const std::size_t width = 1 + static_cast<std::size_t>(config.dim);
  depth.resize(most_depth.size());
  for (std::size_t n = 0; n < depth.size(); ++n)
    depth[n] = double(sums[n * width]) * k_depth_quantum * config.mesh.spacing;
}

void Rasters::update(const Config& config, double time, const std::vector<long>& sums) {
  look(config, sums);
  const RasterConfig& options = config.rasters;
  const std::size_t width = 1 + static_cast<std::size_t>(config.dim);
  for (std::size_t n = 0; n < depth.size(); ++n) {
    most_depth[n] = std::max(most_depth[n], depth[n]);
    if (!(depth[n] > options.threshold_depth)) continue;
    double square = 0;  // of the sum of velocities
    for (std::size_t d = 1; d < width; ++d)
      square += double(sums[n * width + d]) * double(sums[n * width + d]);
    const double speed = std::sqrt(square) / double(sums[n * width]);
    most_speed[n] = std::max(most_speed[n], speed);
    const bool fast = !options.threshold_speed || speed > *options.threshold_speed;
    if (arrival[n] == k_never && fast) arrival[n] = time;
  }
}

PetscErrorCode Rasters::write(const Config& config, const std::string& folder) const {
  PetscFunctionBeginUser;
  const ColumnGrid grid = column_grid(config);
  if (config.dim == 3) {
    for (const auto& [name, values] : {std::pair{"max_depth", &most_depth},
                                       {"max_speed", &most_speed},
                                       {"arrival_time", &arrival},
                                       {"final_depth", &depth}})
      PetscCall(replace_file(folder + "/raster_" + name + ".asc", ascii_grid(grid, config, *values)));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  std::string text = "x,max_depth,max_speed,arrival_time,final_depth\n";
  for (std::size_t n = 0; n < depth.size(); ++n) {
    const double x = config.mesh.lower[0] + config.rasters.origin[0] + (double(n) + 0.5) * grid.cell;
    text += text_of(x) + "," + text_of(most_depth[n]) + "," + text_of(most_speed[n]) + "," +
            (arrival[n] == k_never ? "nan" : text_of(arrival[n])) + "," + text_of(depth[n]) + "\n";
  }
  PetscCall(replace_file(folder + "/rasters.csv", text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

bool are_sound(const Rasters& rasters, const Config& config) {
  const std::size_t count = config.rasters.on ? static_cast<std::size_t>(column_grid(config).count()) : 0;
  for (const auto* values : {&rasters.most_depth, &rasters.most_speed, &rasters.arrival})
    if (values->size() != count || !std::all_of(values->begin(), values->end(),
                                                [](double x) { return std::isfinite(x) && x >= k_never; }))
      return false;
  return true;
}

}  // namespace mpm
