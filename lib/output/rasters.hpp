#pragma once
// Rasters of what has passed over the ground: greatest depth and speed of the soil, its time of arrival, and
// its depth at the end. All ranks hold them whole.

#include <petscsys.h>

#include <string>
#include <vector>

#include "data/probe_data.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// The grid of the rasters: from the lower corner of the mesh on. Its last cells may reach beyond the mesh.
ColumnGrid column_grid(const Config& config);

/// Bytes that the rasters take: of the device where kernels run, and of the host.
struct RasterBytes {
  double device = 0, host = 0;
};
RasterBytes raster_bytes(const Config& config);

/// The time of arrival of soil that has not arrived, in checkpoints; NaN in rasters.csv.
inline constexpr double k_never = -1;

/// The rasters, row by row from the lowest y.
struct Rasters {
  std::vector<double> most_depth, most_speed;  // m, m/s
  std::vector<double> arrival;                 // s; k_never
  std::vector<double> depth;                   // m, at the last update; no checkpoint has it

  /// No soil has come yet.
  void begin(const Config& config);
  /// Takes the depth from the sums of all ranks (column_sums).
  void look(const Config& config, const std::vector<long>& sums);
  /// Updates the rasters at a time [s] whose depth and speed count.
  void update(const Config& config, double time, const std::vector<long>& sums);
  /// Writes raster_*.asc, or rasters.csv in 2D, to the folder. On one rank.
  PetscErrorCode write(const Config& config, const std::string& folder) const;
};

/// Whether rasters of a checkpoint are sound.
bool are_sound(const Rasters& rasters, const Config& config);

}  // namespace mpm
