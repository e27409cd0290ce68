#include "functions/step_kernels.hpp"
#include "loops/gpu/patch_update.hpp"

namespace mpm {

template <class Space, class T, int Dim>
StepPlan plan_step(const State<Space, T, Dim>& s) {
  constexpr int k_few =
      2000;  // patches that a device has all at once, so that a step should take few launches
  const bool tile = chosen(s.p2g.strategy) == P2G::tile, one_rank = s.owned_nodes.extent(0) == 0;
  const bool few = s.patches.slots < k_few, batches = s.batches.in_use();
  // One thread gains nothing by sums ahead, and the log tells its functions apart. On a GPU the scratch
  // memory must hold the update and the sums.
  const bool fit = is_device<Space> ? sums_fit<Space, T, Dim> : has_windows(s.space);
  StepPlan plan;
  // XPIC and APIC ask for the nodal sums again. Submerged soil also gives the nodes the water it displaces.
  // The energy balance looks at the sums between functions 4 and 5, and loads on surfaces do so too.
  plan.sums_ahead = fit && tile && s.xpic_order == 0 && !s.affine && !s.water.is_there() && !s.energy.on &&
                    !s.loads.in_use();
  plan.writes_sums = has_windows(s.space) && tile && !batches;
  // Patches far from rigids need few registers: where they are many, they go faster with a launch of their
  // own. What follows a table is set where the rigids move, so that no node may be updated meanwhile; and
  // what moves beside the sides, on the main stream.
  plan.nodes_apart = is_device<Space> && !few && !s.rigid_points.empty() && s.near_count > 0 &&
                     !s.timed.moves_gravity && !s.timed.moves_sides && !s.sides.has_columns();
  if (batches)
    plan.form = StepForm::out_of_core;
  else if (plan.sums_ahead)
    plan.form = StepForm::fused;
  if constexpr (is_device<Space>)
    if (plan.form == StepForm::fused && few && one_rank && !s.soil.points.rings && s.soil.points.count > 0 &&
        ends_in_launch(s))
      plan.form = StepForm::persistent;
  return plan;
}

#define MPM_INSTANTIATE(Space, T, Dim) template StepPlan plan_step(const State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
