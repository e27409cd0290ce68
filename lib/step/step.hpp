#pragma once
// One time step, in the paper's words.

#include "particle_to_node.hpp"
#include "step/timers.hpp"
#include "step_kernels.hpp"

namespace mpm {

/// Function 2: each rigid body's mass and normal direction to the nodes.
template <class Space, class T, int Dim>
void rigids_to_nodes(State<Space, T, Dim>& s) {
  for (std::size_t r = 0; r < s.rigid_points.size(); ++r) {
    const auto& set = s.rigid_points[r];
    const NodeField<Space, T, RigidShare<Dim>::size> out =
        Kokkos::subview(s.nodes.rigid, static_cast<int>(r), Kokkos::ALL, Kokkos::ALL);
    particle_to_node(s.p2g.strategy, Interpolation<RigidSource<Space, T, Dim>>{s.space, s.grid, s.patches, set.bins, {set.points},
                                                                               out, s.control, s.p2g.mosaic_cells});
  }
}

/// Function 3: the soil's mass, momentum and internal force to the nodes, and its volume where an interface needs it.
template <class Space, class T, int Dim>
void soil_to_nodes(State<Space, T, Dim>& s) {
  const auto& set = s.soil;
  particle_to_node(s.p2g.strategy, Interpolation<SoilSource<Space, T, Dim>>{s.space, s.grid, s.patches, set.bins,
                                                                            {set.points, s.grid.inv_spacing}, s.nodes.soil,
                                                                            s.control, s.p2g.mosaic_cells});
  if (s.interface_shear)
    particle_to_node(s.p2g.strategy, Interpolation<VolumeSource<Space, T, Dim>>{s.space, s.grid, s.patches, set.bins, {set.points},
                                                                                s.nodes.volume, s.control, s.p2g.mosaic_cells});
}

/// Advances one explicit step of dt [s]. Does nothing while s.control is paused. The rebuild, function 7, is the
/// caller's, when the movement bound says so.
template <class Space, class T, int Dim>
PetscErrorCode step(State<Space, T, Dim>& s, Timers& timers, double dt) {
  PetscFunctionBeginUser;
  const auto wait = [&] { s.space.fence("mpm::step"); };
  PetscCall(timers.run(Function::reset, [&] { reset_nodes(s); }, wait));                  // 1 initialise nodal variables
  PetscCall(timers.run(Function::rigid_to_nodes, [&] { rigids_to_nodes(s); }, wait));     // 2 rigid bodies to nodes
  PetscCall(timers.run(Function::soil_to_nodes, [&] { soil_to_nodes(s); }, wait));        // 3 soil particles to nodes
  PetscCall(timers.run(Function::nodes, [&] { update_nodes(s, dt); }, wait));             // 4 velocities, walls, contact
  PetscCall(timers.run(Function::particles, [&] { update_particles(s, dt); }, wait));     // 5 stress update, movement
  PetscCall(timers.run(Function::rigids, [&] { move_rigids(s, dt); }, wait));             // 6 move the rigid bodies
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
