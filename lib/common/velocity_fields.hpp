#pragma once
// Velocity fields of the deformable bodies of a run.

#include <vector>

#include "mpm/config.hpp"

namespace mpm {

inline constexpr int k_most_velocity_fields = 8;

/// The velocity field of each body, and how many there are. A body that -contact_pairs names has one of its
/// own; all others share the first.
struct VelocityFields {
  std::vector<int> of_body;
  int count = 1;
};
VelocityFields velocity_fields(const Config& config);

}  // namespace mpm
