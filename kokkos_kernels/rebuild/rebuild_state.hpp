#pragma once
// A rebuild of all floors of a run's data (data/floors.hpp).

#include "data/features_of.hpp"
#include "data/state_memory.hpp"
#include "functions/follow_soil.hpp"
#include "functions/step_kernels.hpp"
#include "functions/surface_loads.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {

/// The plan of the steps until the next rebuild, on one rank; several ranks may overlap theirs. After lists
/// are made.
template <class Space, class T, int Dim>
StepPlan plan_step(const State<Space, T, Dim>& s) {
  bool launch_has_room = false;
  if constexpr (is_device<Space>) launch_has_room = ends_in_launch(s);
  return plan_step(s, features_of(s), launch_has_room);
}

/// Makes the patch table, the order of the points, their bins and the strategy's lists from the points'
/// addresses, plans the steps, and resets the movement bound. Nodal fields are laid out anew and hold
/// nothing.
template <class Space, class T, int Dim>
void sort_and_list(State<Space, T, Dim>& s) {
  sort_points_and_list(s);
  s.plan = plan_step(s);
  make_room(s, uses_of_nodes(s));
  if (s.loads.in_use()) list_loaded(s, s.loads);
  if (s.energy.on) s.energy.make_room(s.soil.points.count);
  if (s.batches.in_use()) {
    drop_batches(s);
    plan_batches(s, memory_of(s));
  }
  reset_bound(s);
}

/// A whole rebuild on one rank, with domains that follow the soil, but for what splits, merges and moves
/// particles.
template <class Space, class T, int Dim>
void rebuild(State<Space, T, Dim>& s) {
  if (s.soil.points.has_domain) sum_drift(s), stretch_domains(s);
  locate(s);
  sort_and_list(s);
  begin_domains(s);
}

}  // namespace mpm
