#include "run/time_step.hpp"

#include <cmath>

#include "check/spring_step.hpp"
#include "common/courant.hpp"
#include "common/text.hpp"

namespace mpm {
namespace {

constexpr double k_round_off = 1e-12;
constexpr long k_look_every = 20;  // steps between two computations of wave speeds, at most
constexpr double k_calm =
    1.15;  // largest growth of the fastest wave's speed for which they are more than one
constexpr double k_growth = 1.1;  // largest growth of the step from one measure to the next
constexpr double k_logged = 0.2;  // least change of the step that the log reports

/// Why a fixed time step is no longer stable. speed [m/s]: that of the fastest wave, which counts for more
/// where a particle's domain is short.
std::string what_shortens_the_step(const Config& config, double speed) {
  if (config.particle_domain != ParticleDomain::fixed)
    return "domains of particles have become shorter, or the soil stiffer";
  return formatted("the soil has become stiffer, with waves of %.4g m/s", speed);
}

/// Speed of the fastest wave [m/s], once the soil has closed in for a time [s] as fast as it can: at the
/// speed `closing` [m/s] over the edge of a cell, to which gravity adds.
PetscErrorCode wave_within(const Config& config, Stepper& stepper, double seconds, double closing,
                           double* speed) {
  PetscFunctionBeginUser;
  double gravity = 0;
  for (const double g : config.gravity) gravity += std::fabs(g);
  PetscCall(stepper.fastest_wave((closing + gravity * seconds) * seconds / config.mesh.spacing, speed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Prints how much Rayleigh damping shortens the step.
PetscErrorCode report_damped_step(const Config& config, const StepLimits& limits, Log& log) {
  PetscFunctionBeginUser;
  if (!(config.rayleigh_mass > 0 || config.rayleigh_stiffness > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  Config without = config;
  without.rayleigh_mass = without.rayleigh_stiffness = 0;
  PetscCall(log.print("stable time step: %.6g s, and %.6g s without Rayleigh damping",
                      step_of(limits, largest_courant(config), config),
                      step_of(limits, largest_courant(config), without)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode TimeStep::choose(Job& job, Clock& clock) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const StepLimits limits{critical_time_step(config), viscous_time_step(config)};
  laws_follow_ = stiffness_changes(config);
  follows_ = laws_follow_ || config.particle_domain != ParticleDomain::fixed;
  const double dt = clock.dt = config.time.step.value_or(step_of(limits, config.time.courant, config));
  const double largest = step_of(limits, largest_courant(config), config);
  if (dt > largest * (1 + k_round_off))
    job.report.errors.push_back(formatted(
        "mpm: -time_step: given \"%g\", takes a time in s of at most %.6g, above which the step is unstable",
        dt, largest));
  if (const std::string fault = spring_fault(config, dt); !fault.empty()) job.report.errors.push_back(fault);
  if (config.time.end / dt > k_most_steps)
    job.report.errors.push_back(
        formatted("mpm: -time_end: given \"%g\", takes at most %g s with time steps of %g s (1e12 steps)",
                  config.time.end, k_most_steps * dt, dt));
  else
    clock.schedule = Schedule(config.time, config.output, dt, clock.stage_begin());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TimeStep::report(Job& job, const Clock& clock) const {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  const Schedule& schedule = clock.schedule;
  const StepLimits limits{critical_time_step(config), viscous_time_step(config)};
  if (follows_ && !config.time.step)
    PetscCall(job.log.print(
        "time step %.9g s, which follows the stiffness of the soil: Courant number %.4f, of at most %.4f",
        clock.dt, config.time.courant, largest_courant(config)));
  else
    PetscCall(job.log.print("time step %.9g s, Courant number %.4f, of at most %.4f; %ld steps to %g s",
                            clock.dt, clock.dt / limits.wave, largest_courant(config), schedule.last_step(),
                            schedule.time_of(schedule.last_step())));
  if (std::isfinite(limits.viscous)) {
    const auto [waves, viscosity] = largest_steps(limits, config);
    PetscCall(job.log.print("stable time step: %.6g s by waves alone, %.6g s by viscosity alone: %s governs",
                            waves, viscosity, waves < viscosity ? "the speed of waves" : "the viscosity"));
  }
  PetscCall(report_damped_step(config, limits, job.log));
  PetscFunctionReturn(PETSC_SUCCESS);
}

long TimeStep::next_check(const Clock& clock) const {
  return laws_follow_ ? std::max(waves_.due, clock.step + 1) : clock.schedule.last_step();
}

/// The fastest wave [m/s] until the next look, and when that is due: as many steps ahead as the soil cannot
/// become much stiffer in. Soil whose stiffness grows with its pressure becomes many times as stiff within a
/// step where it closes in fast: the speed is then that at the end of the step.
PetscErrorCode TimeStep::look_ahead(const Config& config, Stepper& stepper, long step, double* speed) {
  PetscFunctionBeginUser;
  const auto step_at = [&](double wave) {
    return config.time.step.value_or(
        step_of({config.mesh.spacing / wave, viscous_time_step(config)}, config.time.courant, config));
  };
  double now = 0, after = 0, closing = 0;
  PetscCall(stepper.fastest_wave(0, &now));
  *speed = now;
  if (!(now > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(stepper.closing_speed(&closing));
  const bool grew = now > k_calm * waves_.speed;
  long every = grew ? std::max(1L, waves_.every / 2) : std::min(k_look_every, 2 * waves_.every);
  for (;; every /= 2) {
    PetscCall(wave_within(config, stepper, static_cast<double>(every) * step_at(now), closing, &after));
    if (every == 1 || after <= k_calm * now) break;
  }
  waves_ = {.due = step + every, .every = every, .speed = now};
  *speed = std::max(now, after);
  constexpr int k_halvings = 5;  // of the logarithm
  double low = now;              // too low a speed
  for (int n = 0; n<k_halvings&& * speed> k_calm * low; ++n) {
    const double middle = std::sqrt(low * *speed);
    PetscCall(wave_within(config, stepper, step_at(middle), closing, &after));
    (after > middle ? low : *speed) = middle;
  }
  if (config.time.step) *speed = now;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TimeStep::follow(Job& job, Stepper& stepper, bool now, Clock& clock) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  double& dt = clock.dt;
  const bool due = now || (laws_follow_ && clock.step >= waves_.due);
  if (!follows_ || !due || computed_at_ == clock.step) PetscFunctionReturn(PETSC_SUCCESS);
  computed_at_ = clock.step;
  double speed = 0;
  PetscCall(laws_follow_ ? look_ahead(config, stepper, clock.step, &speed) : stepper.fastest_wave(0, &speed));
  if (!(speed > 0)) PetscFunctionReturn(PETSC_SUCCESS);  // no soil is left
  const StepLimits limits{config.mesh.spacing / speed, viscous_time_step(config)};
  const double largest = step_of(limits, largest_courant(config), config);
  if (config.time.step) {
    if (dt > largest * (1 + k_round_off))
      PetscCall(fail(job, clock,
                     formatted("-time_step: given \"%g\", takes at most %.6g s now that %s; leave it out, "
                               "and the step follows the soil",
                               *config.time.step, largest, what_shortens_the_step(config, speed).c_str())));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  const double wanted = step_of(limits, config.time.courant, config);
  dt = clock.step > 0 && laws_follow_ ? std::min(wanted, k_growth * dt) : wanted;
  clock.schedule = Schedule(config.time, config.output, dt, {clock.step, clock.time()});
  if (logged_ > 0 && std::fabs(dt - logged_) <= k_logged * logged_) PetscFunctionReturn(PETSC_SUCCESS);
  if (logged_ > 0)
    PetscCall(
        job.log.print("step %ld: the time step follows the stiffness of the soil: %.4g s", clock.step, dt));
  logged_ = dt;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
