#pragma once
// Loads on parts of bodies' surfaces, which move with them: pressures and tractions. Soil::faces has each
// particle's part of the surface.

#include "data/nodes.hpp"
#include "data/particles.hpp"

namespace mpm {

/// A load in the step at hand.
template <int Dim>
struct SurfaceLoad {
  double pressure;       // Pa, against the normal out of the soil
  double traction[Dim];  // Pa, of the area at the start
  int on_pores = 0;      // 1: the pressure acts on the water in the pores too, else 0
};

/// All loads of a run, and what their sums at the nodes need.
template <class Space, class T, int Dim>
struct SurfaceLoads {
  using Memory = typename Space::memory_space;
  Kokkos::View<SurfaceLoad<Dim>*, Memory> now;
  Kokkos::View<double, Memory> work, of_step;  // J, on this rank: since the start, and of one step
  Kokkos::View<int*, Memory> loaded;           // by slot: its place among those with loads, from 1 on; else 0
  int loaded_count = 0;
  bool on_pores = false;               // some load acts on the water in the pores
  NodeField<Space, T, Dim> pore_load;  // N, of such loads at the nodes, of all ranks
  Windows<Space> windows;              // of these slots
  // Faces of each particle along one axis: their places and boxes, as for particles, and their forces [N].
  Kokkos::View<Vector<T, Dim>*, Memory> coordinate, force;
  Kokkos::View<Vector<StoredLength<Space, T>, Dim>*, Memory> half_length;

  bool in_use() const { return now.extent(0) > 0; }
};

}  // namespace mpm
