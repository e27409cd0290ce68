#pragma once
// Position correction (-position_correction delta): between two steps, particles of soil that flows move a
// little from where the volumes of particles overlap to where they leave gaps (the delta-correction of
// Baumgarte & Kamrin 2023). After a rebuild, before the next step:
//   1. sum_present_soil (step/step.hpp)                  mass and momentum at the nodes
//   2. begin_correction; ShareSource to s.nodes.shares   volume at the nodes, V_i = sum S V_p
//   3. find_shifts; ShareSource to s.nodes.shares        shifts; the momentum that they would bring
//   4. apply_shifts                                      positions and velocities
// Between 2 and 3, and 3 and 4, the sums of all ranks are added.

#include "base/spaces.hpp"
#include "data/state.hpp"

namespace mpm {

template <class Space, class T, int Dim>
using CorrectionVectors = Kokkos::View<Vector<T, Dim>*, typename Space::memory_space, Kokkos::MemoryUnmanaged>;

/// What the particles give the nodes, by particle; in s.scratch.
template <class Space, class T, int Dim>
CorrectionVectors<Space, T, Dim> shares_of(const State<Space, T, Dim>& s) {
  return {reinterpret_cast<Vector<T, Dim>*>(s.scratch.data()), std::size_t(s.soil.points.count)};
}
/// Shifts of the particles [cells], by particle; in s.scratch.
template <class Space, class T, int Dim>
CorrectionVectors<Space, T, Dim> shifts_of(const State<Space, T, Dim>& s) {
  const std::size_t count = s.soil.points.count;
  return {reinterpret_cast<Vector<T, Dim>*>(s.scratch.data()) + count, count};
}

/// Makes room in s.scratch, and puts the volumes of the particles into shares_of.
template <class Space, class T, int Dim>
void begin_correction(State<Space, T, Dim>& s);

/// The shift of each particle, from the share f_i of each node's volume that particles fill:
///   delta_p = -min(k_most_diffusion, rate gamma_p) sum_i (f_i - 1) grad S_ip   [cells, 1/cell]
/// with gamma_p the shear strain in `elapsed` [s], the time since the correction before, by the present
/// velocity gradient. Where a node in reach of the particle is at a free surface, nodes that are not full
/// count as full, and the shift has no component normal to the surface. Only particles that have flowed are
/// shifted, none near a rigid body or towards a side of the mesh that is nearer than half the particle.
/// shares_of becomes m_p L_p delta_p [kg m/s], the momentum for the velocity of the new place.
template <class Space, class T, int Dim>
void find_shifts(State<Space, T, Dim>& s, double elapsed);

/// Moves the particles, and gives each the velocity of its new place to first order, less what keeps the
/// momentum at the nodes: v_p += L_p delta_p - sum_i S_ip (sum_q S_iq m_q L_q delta_q) / m_i. Strays::lost
/// counts the energy that this adds.
template <class Space, class T, int Dim>
void apply_shifts(State<Space, T, Dim>& s);

}  // namespace mpm
