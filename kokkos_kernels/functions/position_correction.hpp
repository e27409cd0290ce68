#pragma once
// Position correction (-position_correction delta): between two steps, particles of soil that flows move a
// little from where the volumes of particles overlap to where they leave gaps, after the delta-correction of
// Baumgarte & Kamrin (2023). After a rebuild, before the next step (step/correct_positions.hpp):
//   1. SoilSource, BoundarySource to the nodes    mass, momentum; volume V_i = sum S V_p, area A_i = sum V_p
//   grad S
//   2. compare_volumes                            what is missing of each node's volume
//   3. find_shifts; ValueSource to the nodes      shifts; the momentum that they would bring
//   4. apply_shifts                               positions and velocities

#include "base/spaces.hpp"
#include "data/contact_core.hpp"
#include "data/particle_values.hpp"

namespace mpm {

/// Vector that each particle gives the nodes, by particle; in s.scratch.
template <class Space, class T, int Dim>
ParticleValues<Space, T, Dim> shares_of(const ContactCore<Space, T, Dim>& s) {
  return values_in_scratch<Dim>(s);
}
/// Shifts of the particles [cells], by particle; in s.scratch.
template <class Space, class T, int Dim>
ParticleValues<Space, T, Dim> shifts_of(const ContactCore<Space, T, Dim>& s) {
  const std::size_t count = s.soil.points.count;
  return ParticleValues<Space, T, Dim>(reinterpret_cast<Vector<T, Dim>*>(s.scratch.data()) + count, count);
}

/// Terms of a node for the correction: BoundaryTerms as sums over particles, then these.
template <int Dim>
struct FillTerms {
  static constexpr int filled = 0;  // -, f_i, share of its volume that is filled
  static constexpr int excess = 1;  // -, e_i, what is too much of it
  static constexpr int size = BoundaryTerms<Dim>::size;
};
template <class Space, class T, int Dim>
using FillField = NodeField<Space, T, FillTerms<Dim>::size>;

/// Makes of volume and area at the nodes (BoundaryTerms) how full they are (FillTerms). A node at the depth s
/// [cells] below a free surface that is plane has f = 1 - a^2/2 with a = |A_i| = 1 - s, one above it f =
/// a^2/2. Neither lacks anything:
///   e_i = max(-k, f_i - 1 + a_i^2/2);   0 where f_i - a_i^2/2 is small
template <class Space, class T, int Dim>
void compare_volumes(ContactCore<Space, T, Dim>& s, const FillField<Space, T, Dim>& fill);

/// The shift of each particle:
///   delta_p = -min(k_most_diffusion, rate gamma_p) sum_i e_i grad S_ip   [cells, 1/cell]
/// with gamma_p the shear strain in `elapsed` [s], the time since the correction before, by the present
/// velocity gradient. Near a free surface the shift has no component normal to it. Only particles that have
/// flowed are shifted, none near a rigid body or towards a side of the mesh that is nearer than half the
/// particle. shares_of becomes m_p L_p delta_p [kg m/s], the momentum for the velocity of the new place.
/// Makes room in s.scratch for both.
template <class Space, class T, int Dim>
void find_shifts(ContactCore<Space, T, Dim>& s, const FillField<Space, T, Dim>& fill, double elapsed);

/// Moves the particles, and gives each the velocity of its new place to first order, less what keeps the
/// momentum at the nodes: v_p += L_p delta_p - sum_i S_ip (sum_q S_iq m_q L_q delta_q) / m_i. Strays::lost
/// counts the energy that this adds.
template <class Space, class T, int Dim>
void apply_shifts(ContactCore<Space, T, Dim>& s);

}  // namespace mpm
