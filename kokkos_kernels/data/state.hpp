#pragma once
// Everything that a time step works on, for one execution space, real type and dimension.

#include <cstdint>
#include <vector>

#include "data/contact_slots.hpp"
#include "data/energy_works.hpp"
#include "data/nodes.hpp"
#include "data/position_correction.hpp"
#include "data/rigid.hpp"
#include "data/sides.hpp"
#include "data/soil_batches.hpp"
#include "data/split_patches.hpp"
#include "data/step_plan.hpp"
#include "data/strays.hpp"
#include "data/surface_loads.hpp"
#include "data/timed_loads.hpp"

namespace mpm {

/// Strategy and what its lists are built with.
struct P2GPlan {
  P2G strategy = P2G::automatic;
  double margin = 0.5;  // cells
  int mosaic_cells = 3;
  double reserve = 0;  // cells, that the position correction may move particles beyond the margin
};

/// Which nodal fields hold the sums of what they are of, as it is now.
struct Summed {
  bool soil = false, boundary = false, rigids = false;
  bool in_windows = false;  // those of the soil and its boundary: the windows hold them, for update_nodes
};

template <class Space, class T, int Dim>
struct State {
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
  std::vector<ParticleSet<Space, RigidPoints<Space, T, Dim>>> rigid_points;
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  Kokkos::View<Vertex*, Memory> vertices;  // of the rigids' polygons
  ContactSlots<Space> contact;
  Nodes<Space, T, Dim> nodes;
  NodeSums<Space, T, Dim> next_sums, last_sums;  // of run_persistent_steps, which sets last_sums to zero
  bool next_zero = false;                        // `next_sums` fits and is zero
  bool co_resident = true;  // all teams of run_persistent_steps have fit on the device at once so far
  Kokkos::View<std::uint64_t*, Memory>
      owned_nodes;  // by slot, a bit a node: this rank answers for it; of extent 0 on one rank
  ControlView<Space> control, never_paused;
  Movements<Space> movements;
  Kokkos::View<LaunchBarrier, Memory> launch_barrier;
  Movements<Space, 3> launch_movements;       // of persistent steps
  Kokkos::View<double*, Memory> rigid_force;  // N, of the soil on each rigid in this step
  Kokkos::View<char*, Memory>
      scratch;  // scratch of a rebuild: one field in its new order; of a step: dilatations, XPIC
  Kokkos::View<int*, Memory> marks;  // scratch of a rebuild: which patches hold points

  double time = 0;                // s, before the steps that Control::steps counts
  double spacing = 0;             // m, edge of a cell, whatever T is
  Vector<double, Dim> gravity{};  // m/s2; where it follows a table, what measurements take
  TimedLoads<Space, T, Dim> timed;
  Sides<Space, Dim> sides;                // of the mesh, that act on the soil
  SurfaceLoads<Space, T, Dim> loads;      // on parts of bodies' surfaces
  Water<Dim> water{};                     // hydrostatic, in which the soil is submerged
  Kokkos::View<double*, Memory> density;  // kg/m3, that the soil of each body begins with
  double damping = 0;                     // -
  bool rayleigh = false;                  // Rayleigh damping is in use
  double kick = 1;                        // -, share of the next step by which it changes velocities
  double friction_time = 1;               // s, over which friction takes the mean normal impulse
  double flip_fraction = 1;               // -, what is not FLIP is PIC, or XPIC; 0 with APIC
  int xpic_order = 0;                     // m of XPIC(m), 0 without it
  double f_bar_fraction = 0;              // -, the largest of all materials; each takes its share of it
  bool f_bar_by_material = false;         // bodies differ in material
  bool keeps_stress = false;              // sorting brings no pressures together: at a start from another run
  double rim_scale = 0;  // cells, of domains that stretch: by how much they slow the time step
  double mass_cut = 0;   // kg, nodes below it are at rest (PHYSICS: relative to a particle's mass)
  int rebuild_late = 0;  // steps from the sign that a rebuild is due to it; 0: the host counts them
  StepPlan plan;         // of the steps until the next rebuild
  Summed summed;         // what the step before has summed already
  bool forces_summed =
      false;  // `rigid_force` holds the forces of this step, of all ranks if a rigid moves by them
  bool rigid_moves = false;     // some rigid is not fixed
  bool rigid_dynamic = false;   // some rigid moves by the forces on it
  bool mass_normals = false;    // some rigid's normals are those of its mass gradient
  bool soil_boundary = false;   // some contact needs the soil's boundary at the nodes
  bool shear_fraction = false;  // some contact needs the soil's strength at the nodes
  bool has_friction = false;    // some contact has Coulomb friction

  EnergyWorks<Space, T, Dim> energy;  // in use where the run asks for an energy balance
  PositionCorrection<Space> correction;
};

/// The nodal fields that a run uses.
template <class Space, class T, int Dim>
NodeUses uses_of_nodes(const State<Space, T, Dim>& s) {
  return {.boundary = s.soil_boundary,
          .strength = s.shear_fraction,
          .water = s.water.is_there(),
          .loads = s.loads.in_use(),
          .residual = s.xpic_order > 0,
          .correction = s.correction.on,
          .domains = s.soil.points.has_domain};
}

/// Dilatation rates of particles [1/s].
template <class Space, class T>
using Dilatations = Kokkos::View<T*, typename Space::memory_space, Kokkos::MemoryUnmanaged>;
/// Dilatations that a step works with, in State::scratch.
template <class Space, class T, int Dim>
Dilatations<Space, T> dilatations_of(const State<Space, T, Dim>& s) {
  return Dilatations<Space, T>(reinterpret_cast<T*>(s.scratch.data()), s.soil.points.count);
}

}  // namespace mpm
