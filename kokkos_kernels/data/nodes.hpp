#pragma once
// Nodal fields, and the control block that lives on the device.

#include <cstddef>
#include <cstdint>

#include "base/spaces.hpp"
#include "base/types.hpp"
#include "data/impulse_terms.hpp"
#include "data/patches.hpp"
#include "data/water.hpp"

namespace mpm {

/// A nodal field of N values a node, together in memory.
template <class Space, class T, int N>
using NodeField = Kokkos::View<T* [N], Kokkos::LayoutRight, typename Space::memory_space>;

/// Values that soil gives a node: mass [kg], momentum [kg m/s], internal force [N].
template <int Dim>
struct SoilTerms {
  static constexpr int mass = 0, momentum = 1, force = 1 + Dim, size = 1 + 2 * Dim;
};
/// Terms that soil near a rigid gives a node in addition: the soil's boundary as a vector out of it [m2] and
/// its volume [m3].
template <int Dim>
struct BoundaryTerms {
  static constexpr int area = 0, volume = Dim, size = Dim + 1;
};
/// Terms that soil near a rigid gives a node where the shear limit is a fraction of the soil's strength:
/// strength times volume [Pa m3], and volume [m3]. Their ratio is the mean strength there, whatever happens
/// to other sums.
struct StrengthTerms {
  static constexpr int strength = 0, volume = 1, size = 2;
};
/// Terms that soil gives a node where domains stretch: mass [kg], and mass times the way from the node [kg
/// cells].
template <int Dim>
struct CentreTerms {
  static constexpr int mass = 0, way = 1, size = 1 + Dim;
};
/// Values that a rigid gives a node: mass [kg], mass gradient times the cell's edge [kg] (Eq. 3).
template <int Dim>
struct RigidTerms {
  static constexpr int mass = 0, normal = 1, size = 1 + Dim;
};
/// How the soil lies round a node: the sums over its particles of the volume times the way from the node
/// [m3 cells], and times the products of the way's components [m3 cells2], first the squares.
template <int Dim>
struct CloudTerms {
  static constexpr int way = 0, spread = Dim, size = Dim + Dim * (Dim + 1) / 2;
  /// Place in `spread` of the product of two components.
  KOKKOS_INLINE_FUNCTION static constexpr int place(int i, int j) {
    return i == j ? i : Dim == 2 ? 2 : 2 + i + j;
  }
};
/// Terms that soil gives a node where water flows in its pores, over such particles: sums of S rho_w V, S
/// rho_w V / n [kg] and S V / kappa [kg/s], with kappa = k / (rho_w g); mass of the water whose weight no
/// hydrostatic pressure carries [kg]; S rho_w V w [kg m/s]; and V p grad S [N], p in excess of hydrostatic.
template <int Dim>
struct FlowTerms {
  static constexpr int water = 0, inertia = 1, drag = 2, weight = 3, momentum = 4, force = 4 + Dim,
                       size = 4 + 2 * Dim;
};
/// Values that a node gives such soil: Darcy flux at the end of the step [m/s], its rate of change [m/s2].
template <int Dim>
struct FluxTerms {
  static constexpr int flux = 0, rate = Dim, size = 2 * Dim;
};
/// Values that a node gives the soil: velocity at the end of the step [m/s], acceleration [m/s2].
template <int Dim>
struct NodeKinematics {
  static constexpr int velocity = 0, acceleration = Dim, size = 2 * Dim;
};

/// NodeKinematics of one node, read and written at once.
template <class T, int Dim>
struct alignas(group_alignment<T, NodeKinematics<Dim>::size>) KinematicValues {
  T c[NodeKinematics<Dim>::size];
  KOKKOS_INLINE_FUNCTION const T& operator[](int k) const { return c[k]; }
};

/// Sums at the nodes over particles and rigids.
template <class Space, class T, int Dim>
struct NodeSums {
  NodeField<Space, T, SoilTerms<Dim>::size> soil;
  NodeField<Space, T, BoundaryTerms<Dim>::size> boundary;  // of the soil; allocated with rigids
  Kokkos::View<T* * [RigidTerms<Dim>::size], Kokkos::LayoutRight, typename Space::memory_space>
      rigid;  // [rigid][node]; allocated where a normal comes from the mass gradient
};

template <class Space, class T, int Dim>
struct Nodes : NodeSums<Space, T, Dim> {
  NodeField<Space, T, NodeKinematics<Dim>::size> kinematics;
  NodeField<Space, T, StrengthTerms::size> strength;    // allocated where a contact asks for it
  NodeField<Space, T, DisplacedTerms::size> displaced;  // kg, of water; allocated with it
  NodeField<Space, T, Dim> load;      // N, of loads on surfaces, of this rank's soil; allocated with them
  NodeField<Space, T, Dim> residual;  // kg m/s, of what XPIC has left to show the nodes; allocated for it
  NodeField<Space, T, Dim> shares;    // of the position correction (shares_of); allocated for it
  NodeField<Space, T, CentreTerms<Dim>::size> centre;  // of the soil, where domains stretch
  NodeField<Space, T, CloudTerms<Dim>::size> cloud;    // of the soil, where bodies have velocity fields
  NodeField<Space, T, FlowTerms<Dim>::size> flow;      // of water that flows in pores
  NodeField<Space, T, FluxTerms<Dim>::size> flux;      // likewise
  NodeField<Space, T, Dim> drift;  // kg cells, mass times the way since domains changed last; likewise
  Kokkos::View<T**, Kokkos::LayoutRight, typename Space::memory_space>
      impulse;  // N s, [ImpulseTerms::size a rigid][node], kept from step to step
};

/// Features of a run beside the step of the paper; each brings nodal fields into use.
struct NodeUses {
  bool boundary = false;    // some contact needs the soil's boundary
  bool strength = false;    // some contact needs the soil's strength
  bool water = false;       // soil displaces water
  bool loads = false;       // loads on surfaces
  bool residual = false;    // XPIC
  bool correction = false;  // correction of the particles' positions
  bool domains = false;     // domains stretch
  bool cloud = false;       // contact of deformable bodies
  bool flow = false;        // water flows in pores
};

/// Calls f(name, in_use, field) for every nodal field with one entry a node. The one table of nodal fields: a
/// rebuild makes room for those in use, and memory and its check before a run follow it.
template <class F, class Nodes_>
void for_each_nodal_field(F&& f, Nodes_& nodes, const NodeUses& uses) {
  f("soil", true, nodes.soil), f("kinematics", true, nodes.kinematics);
  f("boundary", uses.boundary, nodes.boundary);
  f("strength", uses.strength, nodes.strength);
  f("displaced", uses.water, nodes.displaced);
  f("load", uses.loads, nodes.load);
  f("residual", uses.residual, nodes.residual);
  f("shares", uses.correction, nodes.shares);
  f("cloud", uses.cloud, nodes.cloud);
  f("flow", uses.flow, nodes.flow), f("flux", uses.flow, nodes.flux);
  f("centre", uses.domains, nodes.centre), f("drift", uses.domains, nodes.drift);
}

/// Why a run cannot go on.
enum class FaultKind : int { none, not_finite, volume, too_fast, outside, alone, law, state, porosity };

/// The first fault that a kernel met.
struct Fault {
  FaultKind kind;
  int particle;        // id
  double position[3];  // m from the mesh's lower corner
};

/// Why steps are paused, as bits.
namespace Pause {
inline constexpr int due = 1,  // the bound passed the margin, a rebuild is due, or a fault
    last = 2,                  // within a launch of several steps: the one at hand is its last
    not_co_resident = 4;       // the device did not hold all teams of such a launch at once
}  // namespace Pause

/// Variables that control the steps until the host reads them again. A step does nothing while `paused`.
struct Control {
  double bound;      // cells that any point can have moved since the last rebuild
  double increment;  // of the last step
  int paused;        // Pause
  int due_in;        // steps to a rebuild that is due; 0: none is
  int steps;         // steps done since the host last read this
  int lost;          // particles that the last locate() found to leave the run
  int fault_count;
  Fault fault;
};

/// Values that teams of one launch read at once while they wait for each other.
struct alignas(8) Signal {
  int ended;   // steps that run_persistent_steps has ended
  int paused;  // Pause, after the last of them; before, Pause::last if the step at hand is to be the last
};
/// The barrier of a launch: how many of its teams have begun, how often teams have been done with their part
/// of a step (of all launches; it may overflow), how often they had before the launch, and the signal for
/// which teams wait. It is apart in memory, since all of them ask for it all the time.
struct LaunchBarrier {
  int begun;
  unsigned arrived, before;
  char apart[128 - 3 * sizeof(int)];
  Signal signal;
};

/// Whether lists must be rebuilt `late` steps after the one that these are of [cells]; speeds may grow by
/// half until then. Several ranks have each other's figures only that late; one rank rebuilds at the same
/// steps nevertheless.
KOKKOS_INLINE_FUNCTION bool rebuild_due(double bound, double increment, double margin, int late) {
  constexpr double k_growth = 1.5;
  return !(bound + late * k_growth * increment <= margin);
}

template <class Space>
using ControlView = Kokkos::View<Control, typename Space::memory_space>;

/// The largest movement of a particle in a step [cells]. Each patch notes that of its own at one of several
/// places, since all at one would wait for each other.
template <class Space>
struct MovementPlaces {
  static constexpr int places = is_device<Space> ? 256 : 16;
  // Non-negative floating-point numbers order like their bit patterns, and GPUs have an atomic maximum for
  // integers.
  std::uint64_t* bits;

  KOKKOS_INLINE_FUNCTION void note(int slot, double moved) const {
    Kokkos::atomic_max(bits + slot % places, Kokkos::bit_cast<std::uint64_t>(moved));
  }
  KOKKOS_INLINE_FUNCTION double noted(int place) const { return Kokkos::bit_cast<double>(bits[place]); }
  KOKKOS_INLINE_FUNCTION void begin(int place) const { bits[place] = 0; }
};
/// Movements of `turns` steps.
template <class Space, int turns = 1>
struct Movements {
  static constexpr int places = MovementPlaces<Space>::places;
  Kokkos::View<std::uint64_t[turns * places], typename Space::memory_space> bits;

  KOKKOS_INLINE_FUNCTION MovementPlaces<Space> of(int turn) const { return {bits.data() + turn * places}; }
};

/// Notes a fault; the first one is kept.
template <class ControlView_>
KOKKOS_INLINE_FUNCTION void report(const ControlView_& control, FaultKind kind, int particle,
                                   const double* position, int dim) {
  if (Kokkos::atomic_fetch_add(&control().fault_count, 1) != 0) return;
  control().fault.kind = kind;
  control().fault.particle = particle;
  for (int d = 0; d < dim; ++d) control().fault.position[d] = position[d];
}

}  // namespace mpm
