#pragma once
// Lowest floor of the data of a time step (data/floors.hpp): no rigid body, side or load is in it.

#include <cstdint>

#include "data/cell_means.hpp"
#include "data/floors.hpp"
#include "data/nodes.hpp"
#include "data/pore_flow.hpp"
#include "data/position_correction.hpp"
#include "data/soil_batches.hpp"
#include "data/split_patches.hpp"
#include "data/step_plan.hpp"
#include "data/strays.hpp"
#include "data/water.hpp"

namespace mpm {

/// Strategy and what its lists are built with.
struct P2GPlan {
  P2G strategy = P2G::automatic;
  double margin = 0.5;  // cells
  int mosaic_cells = 3;
  double reserve = 0;  // cells, that the position correction may move particles beyond the margin
  /// Bins hold the particles nearest to a node, and not those of a cell (rebuild/about_nodes.hpp). Such a
  /// particle reaches no node but this one and those next to it, as long as it keeps to the margin.
  bool about_nodes = false;
};

/// Which nodal fields hold the sums of what they are of, as it is now.
struct Summed {
  bool soil = false, boundary = false, rigids = false;
  bool in_windows = false;  // those of the soil and its boundary: the windows hold them, for update_nodes
  bool contacts = false;    // the soil's boundary, strength and cloud at nodes of contact
};

/// Update of the velocities from step to step, and their damping.
struct TimeScheme {
  double damping = 0;        // -
  bool rayleigh = false;     // Rayleigh damping is in use
  double kick = 1;           // -, share of the next step by which it changes velocities
  double flip_fraction = 1;  // -, what is not FLIP is PIC, or XPIC; 0 with APIC
  int xpic_order = 0;        // m of XPIC(m), 0 without it
  double mass_cut = 0;       // kg, nodes below it are at rest (PHYSICS: relative to a particle's mass)
  double rim_scale = 0;      // cells, of domains that stretch: by how much they slow the time step
};

/// F-bar: means of dilatation over a cell.
struct FBar {
  double fraction = 0;        // -, the largest of all materials; each takes its share of it
  bool by_material = false;   // bodies differ in material
  bool keeps_stress = false;  // sorting brings no pressures together: at a start from another run
};

/// Memory of launches that do many steps each (persistent_launch.hpp).
template <class Space, class T, int Dim>
struct PersistentLaunch {
  NodeSums<Space, T, Dim> next_sums, last_sums;  // run_persistent_steps sets last_sums to zero
  bool next_zero = false;                        // `next_sums` fits and is zero
  bool co_resident = true;                       // all teams have fit on the device at once so far
  Kokkos::View<LaunchBarrier, typename Space::memory_space> barrier;
  Movements<Space, 3> movements;
};

template <class Space, class T, int Dim>
struct Core {
  using Memory = typename Space::memory_space;
  Space space;
  P2GPlan p2g;
  Grid<T, Dim> grid;
  Patches<Space, Dim> patches;
  ParticleSet<Space, Soil<Space, T, Dim>> soil;
  int law = -1;             // index in Materials of the law of all bodies; -1: they differ
  bool light_laws = false;  // all of them are of LightMaterials, and no soil has a pore stiffness
  Strays<Space> strays;
  SplitPatches<Space> split;
  Batches<Space, T, Dim> batches;  // of the soil, where the device's memory does not hold it all
  Nodes<Space, T, Dim> nodes;
  PersistentLaunch<Space, T, Dim> launch;
  Kokkos::View<std::uint64_t*, Memory>
      owned_nodes;  // by slot, a bit a node: this rank answers for it; of extent 0 on one rank
  ControlView<Space> control, never_paused;
  Movements<Space> movements;
  Kokkos::View<char*, Memory>
      scratch;  // of a rebuild: one field in its new order; of a step: dilatations, or ParticleValues
  Kokkos::View<int*, Memory> marks;  // scratch of a rebuild: which patches hold points

  double time = 0;                        // s, before the steps that Control::steps counts
  double spacing = 0;                     // m, edge of a cell, whatever T is
  Vector<double, Dim> gravity{};          // m/s2; where it follows a table, what measurements take
  Water<Dim> water{};                     // hydrostatic, in which the soil is submerged
  PoreFlow<Space, Dim> flow;              // of water in the pores of soil
  Kokkos::View<double*, Memory> density;  // kg/m3, that the soil of each body begins with
  TimeScheme scheme;
  FBar f_bar;
  CellMeans<Space, T> cell_means;  // of F-bar, where bins are about nodes
  PositionCorrection<Space> correction;
  int rebuild_late = 0;  // steps from the sign that a rebuild is due to it; 0: the host counts them
  StepPlan plan;         // of the steps until the next rebuild
  Summed summed;         // what the step before has summed already
};

/// Dilatation rates of particles [1/s].
template <class Space, class T>
using Dilatations = Kokkos::View<T*, typename Space::memory_space, Kokkos::MemoryUnmanaged>;
/// Dilatations that a step works with, in Core::scratch.
template <class Space, class T, int Dim>
Dilatations<Space, T> dilatations_of(const Core<Space, T, Dim>& s) {
  return Dilatations<Space, T>(reinterpret_cast<T*>(s.scratch.data()), s.soil.points.count);
}

}  // namespace mpm
