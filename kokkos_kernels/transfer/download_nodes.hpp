#pragma once
// The soil at the nodes, for output.

#include <vector>

#include "base/spaces.hpp"
#include "data/core.hpp"

namespace mpm {

/// The nodes of the mesh that hold soil, in the order of their numbers in the whole mesh (x fastest, then y).
struct NodeFields {
  std::vector<double> number;              // exact up to 2^53
  std::vector<double> position, velocity;  // m from the mesh's lower corner, m/s [Dim N]: momentum over mass
  std::vector<double> mass;                // kg
};

/// The sums at the nodes must be those of the particles where they are now: sum_present_soil.
template <class Space, class T, int Dim>
NodeFields download_nodes(const Core<Space, T, Dim>& s);

}  // namespace mpm
