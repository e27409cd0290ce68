#pragma once
// Contact between rigid bodies, and of rigid bodies with sides of the mesh: what may touch, and what the
// solution of a step leaves.

#include <utility>
#include <vector>

#include "data/rigid_motion.hpp"
#include "data/surface_samples.hpp"

namespace mpm {

/// A point of the surface of a rigid body, where other bodies may touch it.
template <int Dim>
struct SurfacePoint {
  Vector<double, Dim> x;       // m, in the body as it was placed at the start
  Vector<double, Dim> inward;  // m, way from there to a place a little inside; zero at the centre of a ball
  double radius;               // m, of the sphere around x that is in the body
};

/// A rigid body, or a side of the mesh, for contact with others. Lengths in m from the mesh's lower corner,
/// as it was placed at the start.
template <int Dim>
struct PairBody {
  Surface<Dim> surface;  // its edges are as sharp as those of the shape
  int first, count;      // of its surface points
  bool ball;             // its only point is the centre
  bool sampled;          // the surface, or that of a part, has samples
  Vector<double, Dim> centre;
  double reach;        // m, from `centre` to its farthest point; infinite: it has no end
  double friction;     // -, negative: none is given
  double restitution;  // -, likewise
  bool dynamic;        // it moves by the forces on it
  unsigned sides;      // sides of the mesh that it may touch, by bits 2 direction + 1 for the upper one
};

/// Two bodies that may touch before the next rebuild, a < b. Numbers from that of the rigid bodies on are
/// sides.
struct RigidPair {
  int a, b;
  double friction, restitution;  // -
};

/// Contacts of a pair that count in a step: the points farthest along some directions, and the deepest one.
template <int Dim>
inline constexpr int k_pair_ways = Dim == 2 ? 8 : 14;
template <int Dim>
inline constexpr int k_pair_contacts = k_pair_ways<Dim> + 1;

/// One contact of a pair in a step.
template <int Dim>
struct PairContact {
  int point;                    // number among the surface points of a, and behind them those of b
  Vector<double, Dim> normal;   // from b to a
  Vector<double, Dim> arms[2];  // m, from the centres of mass of a and b
  double gap;                   // m, at the begin of the step
  double before;                // m/s, velocity of parting at the begin of the step
  double least;                 // m/s, velocity of parting at the end of the step, or more
  double yield, slide;  // 1/kg, velocity of an impulse of 1 N s along the normal, and at most along the face
  double lift;          // N s, of the correction of places, as an impulse
  Vector<double, Dim> impulse;  // N s, of b on a in this step
};

/// Motion of a body in the solution of a step.
template <int Dim>
struct PairMotion {
  Vector<double, Dim> velocity, before;  // m/s, at the end of the step as it is known, and at its begin
  AngularVector<Dim> spin, spin_before;  // rad/s
  Vector<double, Dim> lightness;         // 1/kg, 0 where no force moves it
  double ease[Dim == 2 ? 1 : 6];         // 1/(kg m2), inverse of the inertia in space: xx, yy, zz, xy, yz, zx
  Wrench<Dim> impulse;                   // N s, N m s, of contacts in this step
  Wrench<Dim> shift;                     // m, rad, correction of its place
};

/// Action of other rigid bodies on one in a step.
template <int Dim>
struct PairAction {
  Wrench<Dim> wrench;   // N, N m
  Wrench<Dim> shift;    // m, rad: correction of its place, which has no velocity
  Wrench<Dim> impulse;  // N s, N m s, since the host last took it
};

/// Impulse of a contact at the end of a step, with which the next step begins.
struct PairImpulse {
  int a, b, point;
  double impulse[3];  // N s
};

/// Data of the kernels of contact between rigid bodies.
template <class Space, int Dim>
struct PairViews {
  using Memory = typename Space::memory_space;
  Kokkos::View<PairBody<Dim>*, Memory> bodies;  // rigid bodies, and behind them sides of the mesh
  Kokkos::View<SurfacePoint<Dim>*, Memory> points;
  SurfaceTables<Memory, Dim>
      vertices;  // and parts of the surfaces; samples are those of the contact with soil
  Kokkos::View<PairAction<Dim>*, Memory> actions;  // of rigid bodies
  // Until the next rebuild.
  int count = 0, colours = 0;
  Kokkos::View<RigidPair*, Memory> list;             // [count], colour by colour
  Kokkos::View<int*, Memory> begin;                  // [colours + 1]; no two pairs of a colour move one body
  Kokkos::View<int*, Memory> held;                   // [count], contacts of each pair in this step
  Kokkos::View<PairContact<Dim>*, Memory> contacts;  // [count][k_pair_contacts]
  Kokkos::View<PairMotion<Dim>*, Memory> motions;    // [bodies]
};

/// The pairs of a run. `count` is 0 while no two bodies are near each other; steps then have no contact
/// between rigid bodies.
template <class Space, int Dim>
struct RigidPairs : PairViews<Space, Dim> {
  std::vector<std::pair<int, int>> parts;  // pairs that overlap at the start, in order: no contact
  double friction = -1;                    // -, of all pairs; negative: that of the bodies
  bool may_meet = false;                   // some two bodies may come to touch
  std::vector<PairImpulse> saved;          // of a checkpoint, until the lists are made

  bool in_use() const { return this->count > 0; }
};

}  // namespace mpm
