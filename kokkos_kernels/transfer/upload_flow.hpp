#pragma once
// Water that flows in pores, to the device.

#include <array>
#include <vector>

#include "data/core.hpp"

namespace mpm {

/// Pores by material, none where no water flows; the water in them; and PoreFlow::sides.
struct FlowInput {
  std::vector<Pores> pores;
  WaterInPores water;
  std::array<std::array<Wall, 2>, 3> sides{};
};

/// Puts them on the device. After upload(), before lists are made.
template <class Space, class T, int Dim>
void upload_flow(Core<Space, T, Dim>& s, const FlowInput& in);

}  // namespace mpm
