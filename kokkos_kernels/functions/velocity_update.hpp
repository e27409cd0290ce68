#pragma once
// Work of XPIC and APIC in addition to update_particles, before it and with the nodes of the same step. FLIP
// and PIC need neither.

#include "base/spaces.hpp"
#include "data/contact_core.hpp"
#include "data/particle_values.hpp"

namespace mpm {

/// Residual r_p of the particles' velocities after the passes of XPIC so far [m/s]; in s.scratch.
template <class Space, class T, int Dim>
ParticleValues<Space, T, Dim> residual_of(const ContactCore<Space, T, Dim>& s) {
  return values_in_scratch<Dim>(s);
}

/// Pass number `pass` of XPIC(m) (Hammerquist & Nairn 2017): r_p <- r_p - sum_i S_ip r_i, from r_p = v_p,
/// where r_i is the rest as the nodes see it: of the first pass v_i of Eq. (6), then s.nodes.rest over the
/// mass. The last pass takes the residual, (I - S S+)^m v_p, out of v_p, except the fraction of FLIP.
template <class Space, class T, int Dim>
void xpic_pass(ContactCore<Space, T, Dim>& s, int pass);

/// C_p of APIC (Jiang et al. 2015) from the velocities at the end of the step: C_p = B_p D_p^-1 with
/// B_p = sum S v_i (x_i - x_p)^T and D_p = sum S (x_i - x_p)(x_i - x_p)^T.
template <class Space, class T, int Dim>
void take_affine(ContactCore<Space, T, Dim>& s);

}  // namespace mpm
