// The length of the time step: at the start, and where it follows the stiffness of the soil.

#include <cmath>
#include <cstdio>

#include "common/text.hpp"
#include "input/courant.hpp"
#include "simulation_body.hpp"

namespace mpm {
namespace {

constexpr double k_round_off = 1e-12;
constexpr long k_look_every = 20;  // steps between two computations of wave speeds, at most
constexpr double k_calm =
    1.15;  // largest growth of the fastest wave's speed for which they are more than one
constexpr double k_growth = 1.1;  // largest growth of the step from one measure to the next
constexpr double k_told = 0.2;    // least change of the step that the log reports

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

/// How much Rayleigh damping shortens the step.
PetscErrorCode Simulation::Body::tell_damped_step() {
  PetscFunctionBeginUser;
  if (!(config.rayleigh_mass > 0 || config.rayleigh_stiffness > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  Config without = config;
  without.rayleigh_mass = without.rayleigh_stiffness = 0;
  const StepLimits limits{critical_time_step(config), viscous_time_step(config)};
  PetscCall(log.print("stable time step: %.6g s, and %.6g s without Rayleigh damping",
                      step_of(limits, largest_courant(config), config),
                      step_of(limits, largest_courant(config), without)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

long Simulation::Body::next_stiffness_check() const {
  return laws_follow ? std::max(waves.due, step + 1) : schedule.last_step();
}

/// Speed of the fastest wave [m/s], once the soil has closed in for a time [s] as fast as it can: at the
/// speed `closing` [m/s] over the edge of a cell, to which gravity adds.
PetscErrorCode Simulation::Body::wave_within(double seconds, double closing, double* speed) {
  PetscFunctionBeginUser;
  double gravity = 0;
  for (const double g : config.gravity) gravity += std::fabs(g);
  PetscCall(stepper->fastest_wave((closing + gravity * seconds) * seconds / config.mesh.spacing, speed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The fastest wave [m/s] until the next look, and when that is due: as many steps ahead as the soil cannot
/// become much stiffer in. Soil whose stiffness grows with its pressure becomes many times as stiff within a
/// step where it closes in fast: the speed is then that at the end of the step.
PetscErrorCode Simulation::Body::look_ahead(double* speed) {
  PetscFunctionBeginUser;
  const auto step_at = [&](double wave) {
    return config.time.step.value_or(
        step_of({config.mesh.spacing / wave, viscous_time_step(config)}, config.time.courant, config));
  };
  double now = 0, after = 0, closing = 0;
  PetscCall(stepper->fastest_wave(0, &now));
  *speed = now;
  if (!(now > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(stepper->closing_speed(&closing));
  const bool grew = now > k_calm * waves.speed;
  long every = grew ? std::max(1L, waves.every / 2) : std::min(k_look_every, 2 * waves.every);
  for (;; every /= 2) {
    PetscCall(wave_within(static_cast<double>(every) * step_at(now), closing, &after));
    if (every == 1 || after <= k_calm * now) break;
  }
  waves = {.due = step + every, .every = every, .speed = now};
  *speed = std::max(now, after);
  constexpr int k_halvings = 5;  // of the logarithm
  double low = now;              // too low a speed
  for (int n = 0; n<k_halvings&& * speed> k_calm * low; ++n) {
    const double middle = std::sqrt(low * *speed);
    PetscCall(wave_within(step_at(middle), closing, &after));
    (after > middle ? low : *speed) = middle;
  }
  if (config.time.step) *speed = now;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// If the stiffness of some soil changes, as often as look_ahead() says, and where domains have changed:
/// computes dt by the Courant number from the fastest wave until the next look; `now`: at this step too. If
/// the user has fixed dt, the run fails once that dt is not stable.
PetscErrorCode Simulation::Body::follow_stiffness(bool now) {
  PetscFunctionBeginUser;
  const bool due = now || domains_changed() || (laws_follow && step >= waves.due);
  if (!follows || !due || waves_at == step) PetscFunctionReturn(PETSC_SUCCESS);
  waves_at = step;
  double speed = 0;
  PetscCall(laws_follow ? look_ahead(&speed) : stepper->fastest_wave(0, &speed));
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
