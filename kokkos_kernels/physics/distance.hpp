#pragma once
// Distance of a point to the surface of a rigid body.

#include "base/types.hpp"

namespace mpm {

/// Signed distance [m], positive outside, and the outward unit normal there: of a point that is as near to
/// several faces the sum of theirs, none (zero) where they cancel, as in the middle of a plate.
template <int Dim>
struct Distance {
  double value;
  Vector<double, Dim> normal;
  bool
      at_edge;  // an edge of the body, or a rounded one, is the nearest, where its faces differ by 30 degrees
};

inline constexpr double k_edge = 0.866;    // cosine between the normals of faces, less is an edge
inline constexpr double k_on_edge = 1e-9;  // of a cell or a unit vector, less has no direction

}  // namespace mpm
