#pragma once
// From a State on the device to the host.

#include <vector>

#include "base/spaces.hpp"
#include "data/state.hpp"

namespace mpm {

/// Fields of the soil on the host, as wide as SymTensor and Vector are: on one rank in the order of creation,
/// on several those of this rank's particles, in the order of `id`.
struct SoilFields {
  std::vector<int> id;           // rising
  std::vector<double> position;  // m from the mesh's lower corner
  std::vector<double> velocity, stress, volume;
  std::vector<std::vector<double>> history;  // of each column in use
  std::vector<double> mass;                  // kg
  std::vector<double> half_length;           // m [Dim N], where domains stretch
};
template <class Space, class T, int Dim>
SoilFields download_soil(const State<Space, T, Dim>& s);

/// Positions [m from the mesh's lower corner] of a rigid's particles in the order of creation.
template <class Space, class T, int Dim>
std::vector<double> download_rigid_positions(const State<Space, T, Dim>& s, int rigid);

/// The rigids on the host; their impulse is taken: it is set to zero on the device.
template <class Space, class T, int Dim>
std::vector<Rigid<Dim>> take_rigids(State<Space, T, Dim>& s);

}  // namespace mpm
