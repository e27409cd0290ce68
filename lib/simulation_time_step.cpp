// The length of the time step: at the start, and where it follows the stiffness of the soil.

#include <cmath>
#include <cstdio>

#include "common/text.hpp"
#include "input/courant.hpp"
#include "simulation_body.hpp"

namespace mpm {
namespace {

constexpr double k_round_off = 1e-12;
constexpr long k_follow_every =
    20;  // steps from one measure of the fastest wave to the next; rebuilds do not matter
constexpr double k_growth = 1.1;  // largest growth of the step from one measure to the next
constexpr double k_told = 0.2;    // least change of the step that the log tells

/// Why a fixed time step is no longer stable. speed [m/s]: that of the fastest wave, which counts for more
/// where a particle's domain is short.
std::string what_shortens_the_step(const Config& config, double speed) {
  if (config.particle_domain != ParticleDomain::fixed)
    return "domains of particles have become shorter, or the soil stiffer";
  return formatted("the soil has become stiffer, with waves of %.4g m/s", speed);
}

}  // namespace

/// The step from the Courant number (Eq. 14), or the user's where it is stable.
PetscErrorCode Simulation::Body::choose_time_step() {
  PetscFunctionBeginUser;
  const StepLimits limits{critical_time_step(config), viscous_time_step(config)};
  laws_follow = stiffness_changes(config);
  follows = laws_follow || domains_follow();
  dt = config.time.step.value_or(step_of(limits, config.time.courant, config));
  const double largest = step_of(limits, largest_courant(config), config);
  if (dt > largest * (1 + k_round_off)) {
    char line[200];
    std::snprintf(
        line, sizeof line,
        "mpm: -time_step: given \"%g\", takes a time in s of at most %.6g, above which the step is unstable",
        dt, largest);
    report.errors.push_back(line);
  }
  if (config.time.end / dt > k_most_steps) {
    char line[200];
    std::snprintf(line, sizeof line,
                  "mpm: -time_end: given \"%g\", takes at most %g s with time steps of %g s (1e12 steps)",
                  config.time.end, k_most_steps * dt, dt);
    report.errors.push_back(line);
  } else {
    schedule = Schedule(config.time, config.output, dt, stage_begin);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

long Simulation::Body::next_stiffness_check() const {
  return laws_follow ? (step / k_follow_every + 1) * k_follow_every : schedule.last_step();
}

/// If the stiffness of some soil changes, every k_follow_every steps, and where domains have changed:
/// measures the fastest wave and computes dt from it by the Courant number; `now`: at this step too. If the
/// user has fixed dt, the run fails once that dt is not stable.
PetscErrorCode Simulation::Body::follow_stiffness(bool now) {
  PetscFunctionBeginUser;
  const bool due = now || domains_changed() || (laws_follow && step % k_follow_every == 0);
  if (!follows || !due || waves_at == step) PetscFunctionReturn(PETSC_SUCCESS);
  waves_at = step;
  double speed = 0;
  PetscCall(stepper->fastest_wave(&speed));
  if (!(speed > 0)) PetscFunctionReturn(PETSC_SUCCESS);  // no soil is left
  const StepLimits limits{config.mesh.spacing / speed, viscous_time_step(config)};
  const double largest = step_of(limits, largest_courant(config), config);
  if (config.time.step) {
    if (dt > largest * (1 + k_round_off))
      PetscCall(
          fail(formatted("-time_step: given \"%g\", takes at most %.6g s now that %s; leave it out, "
                         "and the step follows the soil",
                         *config.time.step, largest, what_shortens_the_step(config, speed).c_str())));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  const double wanted = step_of(limits, config.time.courant, config);
  dt = step > 0 && laws_follow ? std::min(wanted, k_growth * dt) : wanted;
  schedule = Schedule(config.time, config.output, dt, {step, schedule.time_of(step)});
  if (told_dt > 0 && std::fabs(dt - told_dt) <= k_told * told_dt) PetscFunctionReturn(PETSC_SUCCESS);
  if (told_dt > 0)
    PetscCall(log.print("step %ld: the time step follows the stiffness of the soil: %.4g s", step, dt));
  told_dt = dt;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
