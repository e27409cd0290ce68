#include "data/contact_core.hpp"
#include "functions/step_kernels.hpp"
#include "loops/gpu/patch_update.hpp"

namespace mpm {

template <class Space, class T, int Dim>
StepPlan plan_step(const ContactCore<Space, T, Dim>& s, const Features& features, bool launch_has_room) {
  constexpr int k_few =
      2000;  // patches that a device has all at once, so that a step should take few launches
  const bool few = s.patches.slots < k_few, batches = s.batches.in_use();
  // One thread gains nothing by sums ahead, and the log has a line for each of its functions. On a GPU the
  // scratch memory must hold the update and the sums.
  const bool fit = is_device<Space> ? sums_fit<Space, T, Dim> || s.p2g.about_nodes : has_windows(s.space);
  StepPlan plan;
  plan.sums_ahead = fit && can(s.p2g.about_nodes ? StepWay::about_nodes : StepWay::sums_ahead, features);
  plan.writes_sums = has_windows(s.space) && !features.has(Feature::other_strategy) && !batches;
  // Patches far from rigids need few registers: where they are many, a launch of their own is faster.
  plan.nodes_apart = is_device<Space> && !few && !s.rigid_points.empty() && s.contact.count > 0 &&
                     can(StepWay::nodes_apart, features);
  plan.nodes_aside = plan.nodes_apart && can(StepWay::nodes_aside, features);
  if (batches)
    plan.form = StepForm::out_of_core;
  else if (plan.sums_ahead)
    plan.form = StepForm::fused;
  if constexpr (is_device<Space>)
    if (plan.form == StepForm::fused && few && s.soil.points.count > 0 && !s.p2g.about_nodes &&
        can(StepWay::one_launch, features) && launch_has_room)
      plan.form = StepForm::persistent;
  return plan;
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template StepPlan plan_step(const ContactCore<Space, T, Dim>&, const Features&, bool);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
