#pragma once
// Material points, as plain structs of views. A position is a cell and a coordinate in that cell: [0, 1) when
// the particles are binned, and up to the margin beyond while they drift between two rebuilds.

#include <cstdint>

#include "materials/any.hpp"
#include "patches.hpp"
#include "shape_gimp.hpp"
#include "types.hpp"

namespace mpm {

/// Where points are, and in which order: by slot, by cell in it, and by id in the cell.
template <class Space, class T, int Dim>
struct Points {
  using Memory = typename Space::memory_space;
  int count = 0;  // points that have a slot, the first ones
  int all = 0;    // points in memory: those behind are far from the soil, or go to another rank
  Kokkos::View<Vector<T, Dim>*, Memory> coordinate;  // cells, from the lower corner of `cell`
  Kokkos::View<int*, Memory> cell;                   // number of the cell where the point was binned
  Kokkos::View<int*, Memory> id;                     // order of creation
};

/// What all particles of a body share.
template <class T>
struct BodyProperties {
  T mass;                     // kg, of one particle
  HalfLength<T> half_length;  // cells, of one particle
  int material;               // index into Soil::materials
};

/// The soil: the particles of all deformable bodies.
template <class Space, class T, int Dim>
struct Soil : Points<Space, T, Dim> {
  using Memory = typename Space::memory_space;
  Kokkos::View<Vector<T, Dim>*, Memory> velocity;   // m/s
  Kokkos::View<SymTensor<T, Dim>*, Memory> stress;  // Pa, Cauchy, tension positive
  Kokkos::View<T*, Memory> volume;                  // m3, current
  Kokkos::View<T*, Memory> plastic_strain;          // -, engineering plastic shear strain
  Kokkos::View<T*, Memory> strength;                // Pa, undrained shear strength
  Kokkos::View<std::uint16_t*, Memory> body;        // index into bodies
  Kokkos::View<Matrix<T, Dim>*, Memory> affine;     // m/s a cell, C_p of APIC; of extent 0 without it

  Kokkos::View<BodyProperties<T>*, Memory> bodies;
  Kokkos::View<AnyMaterial<T>*, Memory> materials;
};

/// The particles of one rigid body. They keep their place in the body, so that their motion gathers no
/// round-off.
template <class Space, class T, int Dim>
struct RigidPoints : Points<Space, T, Dim> {
  using Memory = typename Space::memory_space;
  Kokkos::View<Vector<double, Dim>*, Memory> home;  // cells from the mesh's lower corner, at the start
  T mass = 0;                                       // kg, of one particle
  HalfLength<T> half_length{};                      // cells
  bool surface_normal = false;                      // contact does not ask for their mass at the nodes
};

/// Applies f to the name and the view of every field that holds one entry a particle, but coordinate, cell
/// and id. The one list of fields: sorting, output and checkpoints follow it.
template <class Space, class T, int Dim, class F>
void for_each_named_field(Soil<Space, T, Dim>& s, F&& f) {
  f("velocity", s.velocity), f("stress", s.stress), f("volume", s.volume);
  f("plastic_strain", s.plastic_strain), f("strength", s.strength), f("body", s.body);
  if (s.affine.extent(0) > 0) f("affine", s.affine);
}
template <class Space, class T, int Dim, class F>
void for_each_named_field(RigidPoints<Space, T, Dim>& s, F&& f) {
  f("home", s.home);
}
template <class Points_, class F>
void for_each_field(Points_& points, F&& f) {
  for_each_named_field(points, [&](const char*, auto& field) { f(field); });
}

/// Places for the sums of windows, so that many threads can make them at once.
template <class Space>
struct Windows {
  Kokkos::View<int*, typename Space::memory_space>
      place;  // of the window of a slot, from 1 on; 0: it has none
  Kokkos::View<char*, typename Space::memory_space> sums;  // of the windows, one after the other
};
/// Whether the strategy `tile` needs them.
template <class Space>
bool has_windows(const Space& space) {
  return backend_of<Space> == Backend::openmp && space.concurrency() > 1;
}

/// Ranges of points by cell, and the lists of the strategies that need them. Valid while no point has moved
/// further than the margin that they were built with.
template <class Space>
struct Bins {
  using Memory = typename Space::memory_space;
  Kokkos::View<int*, Memory> begin;      // first point of a cell [cells + 1]
  int first_slot = 0, last_slot = 0;     // slots that may hold points: [first_slot, last_slot)
  Kokkos::View<int*, Memory> by_colour;  // slots that hold points, ordered by colour; on a processor all are
                                         // of one, so that they rise
  int colour_begin[8 + 1] = {};          // ranges of by_colour
  int border = 0;  // of by_colour, on several ranks: slots in front that share nodes with other ranks, all
                   // colours of them; but with OpenMP, where slots rise
  Kokkos::View<int*, Memory> list_begin;  // gather: first entry of a node's list [nodes + 1]
  Kokkos::View<int*, Memory> list;        // gather: points that may reach the node, in order
  Kokkos::View<long*, Memory> blocks;     // mosaic: blocks that hold points, ordered by colour
  int block_begin[8 + 1] = {};            // mosaic: ranges of blocks by colour
  Windows<Space> windows;                 // tile, many threads of a processor
};

/// Some of the slots that hold points, [first, last) of Bins::by_colour, and the queue that works on them.
/// Several parts: on a device, and with one thread.
template <class Space>
struct Part {
  Space space;
  int first, last;
};

/// The bins with these slots alone.
template <class Space>
Bins<Space> bins_of(const Bins<Space>& all, const Part<Space>& part) {
  Bins<Space> bins = all;
  bins.colour_begin[0] = part.first;
  for (int colour = 1; colour <= 8; ++colour) bins.colour_begin[colour] = part.last;
  return bins;
}

/// A set of points with what orders it.
template <class Space, class Points_>
struct Sorted {
  Points_ points;
  Bins<Space> bins;
  Kokkos::View<long*, typename Space::memory_space>
      address;  // scratch of a rebuild: Grid::address_of each point
  Kokkos::View<int*, typename Space::memory_space> order;  // scratch of a rebuild: former place of each point
};

}  // namespace mpm
