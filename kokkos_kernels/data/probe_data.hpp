#pragma once
// Measurements of probes, as plain data on the host. Lengths are from the mesh's lower corner.

#include <array>
#include <vector>

namespace mpm {

/// Which particles a probe takes: those whose centre (`box`: whose domain) is within `reach` of `centre`
/// along each axis, or, with an id, that one and its parts.
struct ProbeRegion {
  std::array<double, 3> centre{}, reach{};  // m; a reach may be infinite
  bool box = false;
  int id = -1;              // -1: any
  std::vector<int> bodies;  // indices; empty: all
};

/// A particle that a probe takes.
struct ProbeParticle {
  int region, id, body;
  double position[3], half_length[3];  // m; of a ring those of its part outside of the axis
  double velocity[3];                  // m/s
  double stress[6];                    // Pa, as the kernels hold it: xx yy zz xy yz zx
  double excess_pressure;              // Pa, of its pore water
  double mass, volume;                 // kg, m3; of a ring the whole one's
};

/// A plane normal to an axis.
struct SectionPlane {
  int axis = 0;
  double place = 0;         // m
  std::vector<int> bodies;  // indices; empty: all
};

/// Soil beyond a plane, and soil that passes it towards growing coordinates.
struct SectionSum {
  double mass = 0;                        // kg, beyond
  double initial_volume = 0;              // m3, of that mass by the density that its soil began with
  double mass_flux = 0;                   // kg/s
  double volume_flux = 0;                 // m3/s, by the present volumes
  std::array<double, 3> momentum_flux{};  // N, carried by what passes
};

/// The columns of soil over a grid of square cells (along x in 2D): of each column its number of quanta, and
/// these times the velocity of the soil [m/s] along each axis. A quantum is a depth of k_depth_quantum cells
/// of the mesh: sums of whole numbers have the same bits in any order, and so on any number of ranks.
struct ColumnGrid {
  std::array<double, 2> lower{};  // m
  double cell = 0;                // m, edge
  std::array<int, 2> cells{};     // along x and y; 1 along y in 2D
  std::vector<int> bodies{};      // indices; empty: all

  long count() const { return long(cells[0]) * cells[1]; }
};
inline constexpr double k_depth_quantum = 0x1p-40;

}  // namespace mpm
