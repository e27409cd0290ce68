#pragma once
// Where rigid bodies are after they have moved, and which of them are in one place.

#include <memory>
#include <vector>

#include "input/geometry/filled.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// The rigid bodies of a configuration, which must outlive this.
class RigidPlaces {
 public:
  explicit RigidPlaces(const Config& config);
  /// Whether two of them have space in common once they have moved by these displacements [m]. Tests the
  /// points of a grid in what their bounds have in common.
  bool share_space(int a, int b, const Vec3& by_a, const Vec3& by_b);

 private:
  Filled& moved(int rigid, const Vec3& by);

  const Config& config_;
  std::vector<Bounds> bounds_;                   // m, before they move
  std::vector<std::unique_ptr<Filled>> filled_;  // once they are asked for
  std::vector<Vec3> by_;                         // m, by which they have moved
};

}  // namespace mpm
