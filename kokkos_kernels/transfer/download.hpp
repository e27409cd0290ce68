#pragma once
// From a State on the device to the host.

#include <vector>

#include "base/spaces.hpp"
#include "data/contact_core.hpp"
#include "data/particle_columns.hpp"

namespace mpm {

/// The soil on the host: the columns that frames have, of this rank's particles in the order of
/// order_for_host. On one rank, where none was split, that is the order of creation. The reference heights
/// are not among them. Positions are from the mesh's lower corner, and stresses total.
struct SoilFields : ParticleColumns {
  std::vector<int> id;                       // of the first body, rising, then of the second
  std::vector<std::size_t> first;            // of each body, and the end of the last one
  std::vector<std::vector<double>> history;  // of each column in use
  std::vector<double> half_length;           // m [Dim N], where domains stretch
  std::vector<double> ancestor;              // ids, where particles split
  std::vector<double> periods;               // [Dim N], Soil::periods of these positions
  std::vector<double> load_area;             // m2 [Dim N], vector of the faces of loads, where there are some
};
/// The order in which particles come to the host: by body, and by id in a body.
template <class Space, class T, int Dim>
std::vector<int> order_for_host(const ContactCore<Space, T, Dim>& s);

template <class Space, class T, int Dim>
SoilFields download_soil(const ContactCore<Space, T, Dim>& s);

/// Positions [m from the mesh's lower corner] of a rigid's particles in the order of creation.
template <class Space, class T, int Dim>
std::vector<double> download_rigid_positions(const ContactCore<Space, T, Dim>& s, int rigid);

/// The rigids on the host; their impulse is taken: it is set to zero on the device.
template <class Space, class T, int Dim>
std::vector<Rigid<Dim>> take_rigids(ContactCore<Space, T, Dim>& s);

}  // namespace mpm
