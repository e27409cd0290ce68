#pragma once
// Functions of a step for soil in whose pores water flows (physics/pore_flow.hpp); the run has some.

#include "data/state.hpp"

namespace mpm {

/// Masses of saturated particles by the volumes of their grains and pores, m = rho_s V_s + rho_w (V - V_s). A
/// porosity out of bounds is a fault. control: of the steps, or never_paused.
template <class Space, class T, int Dim>
void weigh_saturated(const Core<Space, T, Dim>& s, const ControlView<Space>& control);

/// Part of 4, before update_nodes: makes the force at each node the one under which the mixture alone has the
/// acceleration that it has with the water. The sums s.nodes.flow are complete. dt [s].
template <class Space, class T, int Dim>
void couple_flow(State<Space, T, Dim>& s, double dt);

/// Part of 4, after update_nodes: flux at the end of the step, and its rate, by the acceleration of the
/// grains as walls and contact have left it.
template <class Space, class T, int Dim>
void update_flux(State<Space, T, Dim>& s, double dt);

/// Part of 5, before update_particles: pore pressure and flux of the particles.
template <class Space, class T, int Dim>
void update_pores(State<Space, T, Dim>& s, double dt);

}  // namespace mpm
