#pragma once
// A parameter that differs from place to place: values on a grid of points.

#include <string>
#include <vector>

#include "input/geometry/shapes.hpp"

namespace mpm {

/// Values at points that are equally far apart along each axis; linear between them.
struct GridField {
  int dim = 0;
  std::array<long, 3> count{1, 1, 1};  // points along x, y, z (third is 1 in 2D)
  Vec3 lower{}, spacing{1, 1, 1};      // m, first point; distances
  std::vector<double> values;          // x fastest

  double at(const Vec3& x) const;
  Vec3 place_of(std::size_t value) const;  // m, of the point with this value
  double upper(int d) const { return lower[d] + spacing[d] * static_cast<double>(count[d] - 1); }
};

/// The values of the parameter with this key.
struct NamedGrid {
  std::string key;
  GridField grid;
};

/// Whether a file can be read as HDF5 and has a dataset of this name.
bool has_dataset(const std::string& path, const std::string& key);

/// Reads the dataset `key` of an HDF5 file: numbers with the vertical axis first and x last, the place of the
/// first value in its attribute `lower` and the distances in `spacing`, dim numbers each by axis x, y, z
/// (scripts/random_field). Returns what the file should have been, as the end of "takes ..."; empty where all
/// is well.
std::string read_field(const std::string& path, const std::string& key, int dim, GridField& field);

/// Fault of a field that does not reach to the sides of the region that takes its values, as the end of
/// "takes ..."; empty where it does.
std::string uncovered(const GridField& field, const Bounds& bounds, double slack);

}  // namespace mpm
