#pragma once
// The works that an energy balance sums from step to step (-output_energy).

#include "base/ensure.hpp"
#include "base/spaces.hpp"
#include "base/types.hpp"
#include "data/rigid_pose.hpp"

namespace mpm {

/// Works [J] since the start. Those at nodes take the mean of a node's velocity before and after the step, so
/// that their sum is what the nodes' kinetic energy gains.
namespace Work {
inline constexpr int stress = 0,  // of the stress on the strain of the particles: what the soil has taken
    internal = 1,                 // of the internal forces at the nodes
    gravity = 2,                  // of gravity and of the water that carries soil
    damping = 3,                  // of -damping
    boundary = 4,  // of walls and contact at the nodes: what rigids do, and friction and impact
    rigids = 5,    // of the forces of rigids on the soil along the movements of the rigids
    count = 6;
}  // namespace Work

/// Works of the nodes in a step [J], as a sum for parallel_reduce.
struct NodeWorks {
  double internal = 0, gravity = 0, damping = 0, boundary = 0;
  KOKKOS_INLINE_FUNCTION NodeWorks& operator+=(const NodeWorks& other) {
    internal += other.internal, gravity += other.gravity;
    damping += other.damping, boundary += other.boundary;
    return *this;
  }
};

template <class Space, class T, int Dim>
struct EnergyWorks {
  using Memory = typename Space::memory_space;
  bool on = false;
  Kokkos::View<double*, Memory> work;               // J [Work::count], since the start, on this rank
  Kokkos::View<NodeWorks, Memory> of_nodes;         // of one step
  Kokkos::View<double, Memory> of_stress;           // J, of one step
  Kokkos::View<SymTensor<T, Dim>*, Memory> stress;  // Pa, of each particle before the step
  Kokkos::View<SymTensor<T, Dim>*, Memory> strain;  // -, of each particle in the step
  Kokkos::View<T*, Memory> volume;                  // m3, of each particle before the step
  Kokkos::View<RigidPose<Dim>*, Memory> rigid_at;   // of each rigid before the step

  void make_room(int particles) {
    ensure(stress, particles), ensure(strain, particles), ensure(volume, particles);
  }
};

}  // namespace mpm
