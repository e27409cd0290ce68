#pragma once
// One time step, in the paper's words.

#include "batches.hpp"
#include "interpolation.hpp"
#include "parallel/ranks.hpp"
#include "step/beside.hpp"
#include "step/timers.hpp"
#include "step_kernels.hpp"
#include "velocity_update.hpp"

namespace mpm {

/// Interpolation of one source by the strategy that the user chose.
template <class Source, class Space, class T, int Dim>
void interpolate(const State<Space, T, Dim>& s, P2G strategy, const Bins<Space>& bins, const Source& source,
                 const NodeField<Space, T, Source::size>& out, const Space& space) {
  particle_to_node(strategy, interpolation_of(s, bins, source, out, space));
}
template <class Source, class Space, class T, int Dim>
void interpolate(const State<Space, T, Dim>& s, P2G strategy, const Bins<Space>& bins, const Source& source,
                 const NodeField<Space, T, Source::size>& out) {
  interpolate(s, strategy, bins, source, out, s.space);
}

/// Function 2: mass and normal direction to the nodes, of each rigid body whose surface does not tell them.
/// They may be there already.
template <class Space, class T, int Dim>
void rigids_to_nodes(const State<Space, T, Dim>& s, const Space& queue) {
  if (s.summed.rigids) return;
  for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
    const auto& set = s.rigid_points[r];
    if (set.points.surface_normal) continue;
    const NodeField<Space, T, RigidShare<Dim>::size> out =
        Kokkos::subview(s.nodes.rigid, r, Kokkos::ALL, Kokkos::ALL);
    interpolate<RigidSource<Space, T, Dim>>(s, strategy_of_rigids<Space>(s.p2g.strategy), set.bins,
                                            {set.points, s.rigids, r, s.patches.origin, s.spacing}, out,
                                            queue);
  }
}

/// Function 1, where the step before has not done it.
template <class Space, class T, int Dim>
void prepare_nodes(State<Space, T, Dim>& s) {
  if (!s.summed.soil) reset_nodes(s);
}

/// Function 3: the soil's mass, momentum and internal force to the nodes, and its boundary where a contact
/// needs it. Both may be there already.
template <class Space, class T, int Dim>
void soil_to_nodes(const State<Space, T, Dim>& s, const Soil<Space, T, Dim>& points, const Bins<Space>& bins,
                   const Space& space) {
  const P2G how = s.p2g.strategy;
  if (s.affine)
    interpolate<AffineSource<Space, T, Dim>>(s, how, bins, {{points, s.grid.inv_spacing}}, s.nodes.soil,
                                             space);
  else if (!s.summed.soil)
    interpolate<SoilSource<Space, T, Dim>>(s, how, bins, {points, s.grid.inv_spacing}, s.nodes.soil, space);
  if (s.soil_boundary && !s.summed.boundary)
    interpolate<BoundarySource<Space, T, Dim>>(s, how, bins, {points, s.grid.inv_spacing, s.near_rigid},
                                               s.nodes.boundary, space);
}
template <class Space, class T, int Dim>
void soil_to_nodes(const State<Space, T, Dim>& s, const Space& queue) {
  for_all_soil(s, [&](const auto& set) { soil_to_nodes(s, set.points, set.bins, queue); });
}
template <class Space, class T, int Dim>
void soil_to_nodes(const State<Space, T, Dim>& s, const Part<Space>& part) {
  soil_to_nodes(s, s.soil.points, bins_of(s.soil.bins, part), part.space);
}

/// The same on several ranks: where the others wait for it first, unless that has gone out already, and the
/// rest while it travels.
template <class Space, class T, int Dim>
PetscErrorCode soil_to_nodes(State<Space, T, Dim>& s, Ranks<Space, T, Dim>* ranks, const Space& queue) {
  PetscFunctionBeginUser;
  if (ranks) finish_sums(s);
  if (!ranks || !ranks->overlaps(s)) {
    soil_to_nodes(s, queue);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!ranks->sent_ahead()) {
    soil_to_nodes(s, ranks->border(s));
    PetscCall(ranks->send_ahead(s));
  }
  soil_to_nodes(s, ranks->inner(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The soil's nodal sums as it is now, for what is measured between two steps; the next step makes its own.
/// The lists hold, as they do for that step: s.control must not be paused.
template <class Space, class T, int Dim>
void sum_present_soil(State<Space, T, Dim>& s) {
  finish_sums(s);
  if (s.summed.soil) return;
  reset_nodes(s);
  soil_to_nodes(s, s.space);
}

/// The update where it goes on to the sums of the next step: first the particles whose sums other ranks wait
/// for, which travel while the rest is computed.
template <class Space, class T, int Dim>
PetscErrorCode update_and_send(State<Space, T, Dim>& s, double dt, Ranks<Space, T, Dim>& ranks) {
  PetscFunctionBeginUser;
  const Part<Space> border = ranks.border(s);
  update_particles(s, dt, border);
  PetscCall(ranks.send_ahead(s));
  update_particles(s, dt, ranks.inner(s));
  ranks.join(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Function 5: velocities by XPIC or APIC where they are chosen, then the update of the soil's particles;
/// with function 6 if `and_end`.
template <class Space, class T, int Dim>
PetscErrorCode nodes_to_soil(State<Space, T, Dim>& s, double dt, Ranks<Space, T, Dim>* ranks, bool and_end) {
  PetscFunctionBeginUser;
  for (int pass = 0; pass < s.xpic_order; ++pass) {
    if (pass > 0) {
      Kokkos::deep_copy(s.space, s.nodes.rest, T(0));
      interpolate<RestSource<Space, T, Dim>>(s, s.p2g.strategy, s.soil.bins, {s.soil.points, rest_of(s)},
                                             s.nodes.rest);
      if (ranks) PetscCall(ranks->add_rest(s));
    }
    xpic_pass(s, pass);
  }
  if (s.affine) take_affine(s);
  if (ranks && ranks->overlaps(s) && sums_ahead(s))
    PetscCall(update_and_send(s, dt, *ranks));
  else if (s.batches.in_use())
    update_by_batches(s, dt);
  else if (and_end)
    update_and_end(s, dt);
  else
    update_particles(s, dt);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Function 6, under the forces of all ranks.
template <class Space, class T, int Dim>
PetscErrorCode move_rigids(State<Space, T, Dim>& s, double dt, Ranks<Space, T, Dim>* ranks,
                           Beside<Space>* beside) {
  PetscFunctionBeginUser;
  if (ranks) PetscCall(ranks->add_forces(s));
  move_rigids(s, dt, beside ? beside->fork(s.space) : s.space);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Advances one explicit step of dt [s]. Does nothing while s.control is paused. The rebuild, function 7, is
/// the caller's, when the movement bound says so. ranks is null on one rank. Where the soil's sums are there
/// already, what contact waits for, from the movement of the rigids on, may go `beside` the nodes far from
/// it: these know of a pause a step late, and do then what the rebuild throws away. A small problem's rigids
/// move in the launch of its particles, or whole steps are one launch, several of them if there are more
/// `left`; what it does is taken off. Where functions are timed, they have the device for themselves.
template <class Space, class T, int Dim>
PetscErrorCode step(State<Space, T, Dim>& s, Timers& timers, double dt, Ranks<Space, T, Dim>* ranks = nullptr,
                    Beside<Space>* beside = nullptr, long* left = nullptr) {
  PetscFunctionBeginUser;
  PetscErrorCode failed = PETSC_SUCCESS;
  const auto wait = [&] { s.space.fence("mpm::step"); };
  const auto run = [&](Function f, auto&& work) { return timers.run(f, work, wait); };
  const bool may_go_beside = beside && nodes_apart(s) && !s.batches.in_use() && !timers.sampling();
  const bool moves_beside = may_go_beside && sums_ahead(s) && (!ranks || ranks->overlaps(s));
  const bool apart = may_go_beside && s.summed.soil;
  if (beside && !apart) beside->join(s.space);
  const Space& queue = apart ? beside->fork(s.space) : s.space;
  const bool at_once = !ranks && ends_at_once(s) && !timers.sampling();
  if (at_once && is_whole_step(s)) {
    const long most = left ? *left : 1;
    long done = 0;
    const auto work = [&] { return done = whole_steps(s, dt, most); };
    PetscCall(timers.run_many(Function::whole, most, work, wait));  // 4 to 6, and 1 to 3 of the next one
    if (left) *left -= done;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (left) --*left;
  PetscCall(run(Function::reset, [&] { prepare_nodes(s); }));  // 1 initialise nodal variables
  PetscCall(run(Function::rigid_to_nodes, [&] { rigids_to_nodes(s, queue); }));  // 2 rigid bodies to nodes
  PetscCall(
      run(Function::soil_to_nodes, [&] { failed = soil_to_nodes(s, ranks, queue); }));  // 3 soil to nodes
  PetscCall(failed);
  if (ranks) PetscCall(ranks->add_soil(s, queue));                       //   the sum over ranks
  PetscCall(run(Function::nodes, [&] { update_nodes(s, dt, queue); }));  // 4 velocities, walls, contact
  if (apart) beside->join(s.space);
  if (apart && moves_beside && !(ranks && ranks->forces_shared())) sum_forces(s, queue);
  PetscCall(run(Function::particles,
                [&] { failed = nodes_to_soil(s, dt, ranks, at_once); }));  // 5 stress, movement
  PetscCall(failed);
  if (at_once) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(run(Function::rigids, [&] {
    failed = move_rigids(s, dt, ranks, moves_beside ? beside : nullptr);  // 6 move the rigid bodies
  }));
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
