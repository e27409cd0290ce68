#pragma once
// Sums and extents over the particles of a body, for the history and the checks.

#include "spaces.hpp"
#include "state.hpp"

namespace mpm {

/// Extent [m from the mesh's lower corner], kinetic energy [J] and momentum [kg m/s] of one body.
struct BodyMeasure {
  double lower[3], upper[3], kinetic_energy, momentum[3];
};

template <class Space, class T, int Dim>
BodyMeasure measure(const State<Space, T, Dim>& s, int body);

}  // namespace mpm
