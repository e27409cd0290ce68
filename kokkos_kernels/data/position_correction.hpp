#pragma once
// The correction of the particles' positions towards an even density (-position_correction delta).

#include "base/spaces.hpp"

namespace mpm {

/// Largest movement of a particle along an axis in one correction [cells]. The lists of the strategies have
/// this much room beyond the margin.
inline constexpr double k_most_shift = 0.05;

/// Soil that flows, by its law: a column of LawHistory that holds the plastic shear strain, or one of these.
struct Flow {
  static constexpr int never = -2;   // the law has no plastic strain
  static constexpr int always = -1;  // a fluid without strength
};

template <class Space>
struct PositionCorrection {
  bool on = false;
  double rate = 0;  // -, diffusion number for a unit of shear strain
  Kokkos::View<int*, typename Space::memory_space> flow_column;  // by material: column of LawHistory, or Flow
};

}  // namespace mpm
