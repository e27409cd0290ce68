#pragma once
// Velocity fields of the deformable bodies of a run.

#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Velocity field of each body, and number of fields. A body that -contact_pairs names has a field of its
/// own, or that of the body with which it is welded, if no other pair has either; all others share the first
/// field.
struct VelocityFields {
  std::vector<int> of_body;
  int count = 1;
};
VelocityFields velocity_fields(const Config& config);

/// Pairs whose two bodies have fields of their own, in the order of Config::contact_pairs: the history has
/// rows of them.
std::vector<ContactPairConfig> pairs_of_fields(const Config& config);

}  // namespace mpm
