#pragma once
// Surfaces of rigid bodies that may touch each other, to the device.

#include <array>
#include <limits>
#include <vector>

#include "data/saved_state.hpp"
#include "transfer/upload.hpp"

namespace mpm {

/// Points of the surface of a rigid body, as SurfacePoint [m, from the mesh's lower corner].
struct SurfacePoints {
  std::vector<std::array<double, 3>> points, inward;
  std::vector<double> radius;
};

/// A rigid body, or a side of the mesh, for contact with others, as PairBody. Lengths in m from the mesh's
/// lower corner.
struct PairBodyInput {
  SurfaceInput surface;
  SurfacePoints points;
  bool ball = false;
  std::array<double, 3> centre{};
  double reach = std::numeric_limits<double>::infinity();
  double friction = -1, restitution = -1;
  bool dynamic = false;
  unsigned sides = 0;
};

/// The bodies of a run: rigid bodies, and behind them the sides of the mesh, or none where no two may meet.
struct PairInput {
  std::vector<PairBodyInput> bodies;
  double friction = -1;  // -, of all pairs of rigid bodies; negative: that of the bodies
};

/// Puts the surfaces on the device, before the rigid bodies, whose samples they take. spacing [m]: edge of
/// the cells.
template <class Space, class T, int Dim>
void upload_pairs(ContactCore<Space, T, Dim>& s, const PairInput& in, double spacing);

/// The contacts and impulses that a checkpoint keeps, and back from one, before the pairs are listed.
template <class Space, class T, int Dim>
SavedPairs save_pairs(const ContactCore<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void restore_pairs(ContactCore<Space, T, Dim>& s, const SavedPairs& saved);

}  // namespace mpm
