// Gravity, damping, and how particles follow the soil; the time and its steps.

#include "common/courant.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/options/analysis_options.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

void read_velocity_update(OptionReader& in, Config& config) {
  VelocityUpdate& update = config.velocity_update;
  in.word({.name = "velocity_update",
           .meaning = "how particles take their velocity from the nodes",
           .standard = in.listing() ? "flip, or apic with -analysis flow" : ""},
          Words<VelocityUpdate>{{"flip", VelocityUpdate::flip},
                                {"pic", VelocityUpdate::pic},
                                {"xpic", VelocityUpdate::xpic},
                                {"apic", VelocityUpdate::apic}},
          update);
  const std::string chosen = "-velocity_update is " + (set_by_flow(in, config, "velocity_update")
                                                           ? "apic by -analysis flow"
                                                           : in.given_text("velocity_update"));
  const bool xpic = update == VelocityUpdate::xpic;
  if (update != VelocityUpdate::flip) config.flip_fraction = 0;
  if (const auto only = in.where("velocity_update", {"flip", "xpic"}); update == VelocityUpdate::flip || xpic)
    in.number({.name = "flip_fraction",
               .meaning = "fraction of FLIP in the velocity update, the rest PIC, or XPIC with xpic",
               .unit = "-",
               .range = {.lowest = 0, .highest = 1},
               .standard = in.listing() ? "1 with flip, 0 with xpic" : "",
               .change = k_at_stages},
              config.flip_fraction);
  else
    in.not_taken("flip_fraction", chosen);
  if (const auto only = in.where("velocity_update", {"xpic"}); xpic || in.listing())
    in.integer({.name = "xpic_order",
                .meaning = "order m of XPIC(m): the higher, the less it damps",
                .unit = "-",
                .range = {.lowest = 2, .highest = 20}},
               config.xpic_order);
  else
    in.not_taken("xpic_order", "-velocity_update is not xpic");
}

void read_position_correction(OptionReader& in, Config& config) {
  in.word({.name = "position_correction",
           .meaning = "delta: particles of soil that flows move a little, by less than 0.05 cells at each "
                      "rebuild, from where they crowd to where they leave gaps",
           .standard = in.listing() ? "none, or delta with -analysis flow" : "",
           .change = k_at_stages},
          Words<bool>{{"none", false}, {"delta", true}}, config.position_correction);
  if (const auto only = in.where("position_correction", {"delta"});
      config.position_correction || in.listing())
    in.number(
        {.name = "position_correction_rate",
         .meaning = "how fast the density of particles diffuses: diffusion number, in cells, for a unit "
                    "of shear strain",
         .unit = "-",
         .range = {.lowest = 0, .highest = 100, .open_lowest = true},
         .change = k_at_stages},
        config.position_correction_rate);
  else
    in.not_taken("position_correction_rate", "-position_correction is none");
}

/// Gravity, water, damping and the factor of strength.
void read_forces(OptionReader& in, Config& config) {
  const Option gravity{.name = "gravity",
                       .meaning = "acceleration of gravity",
                       .unit = "m/s2",
                       .range = k_speed,
                       .change = k_by_choice};
  in.vector(gravity, config.dim, config.gravity);
  read_timed(in, gravity, true, config.dim, config.time.end, config.gravity, config.gravity_table);
  if (config.gravity_table) config.gravity = largest_of(*config.gravity_table);
  read_water(in, config);
  in.number({.name = "damping",
             .meaning = "local (non-viscous) damping factor",
             .unit = "-",
             .range = {.lowest = 0, .highest = 1, .open_highest = true},
             .change = k_by_choice},
            config.damping);
  read_rayleigh(in, config);
  in.number(
      {.name = "strength_factor",
       .meaning = "what the strength of all materials without a strength_factor of their own is divided "
                  "by, as in a search for a factor of safety",
       .unit = "-",
       .range = {.lowest = 0.01, .highest = 100},
       .change = k_by_choice},
      config.strength_factor);
}

}  // namespace

void read_time(OptionReader& in, TimeConfig& time) {
  in.section("Time");
  in.number({.name = "time_end",
             .meaning = "time to simulate",
             .unit = "s",
             .range = k_positive,
             .required = true,
             .change = k_always},
            time.end);
  in.number({.name = "time_step",
             .meaning = "the time step itself, instead of the Courant number",
             .unit = "s",
             .range = k_positive,
             .change = k_at_stages},
            time.step);
  const auto only = in.unless("time_step");
  in.number(
      {.name = "time_courant",
       .meaning =
           "Courant number that gives the time step, at most 0.6, sqrt(2 / (dim n)) for "
           "bodies of n particles along a cell's edge, and less with damping; by default 0.5, or 95 % of "
           "that if it is less",
       .unit = "-",
       .range = {.lowest = 0, .highest = k_largest_courant, .open_lowest = true},
       .standard = time.step ? "none" : "",
       .change = k_at_stages},
      time.courant);
  if (!in.listing() && in.given("time_step") && in.given("time_courant"))
    in.reject("time_step", "the place of -time_courant, which is given too; give one of them");
  in.integer({.name = "time_max_steps",
              .meaning = "stop after so many steps",
              .unit = "steps",
              .range = {.lowest = 1},
              .change = k_at_any_restart},
             time.max_steps);
}

void limit_courant(OptionReader& in, Config& config) {
  if (in.listing() || config.time.step || config.bodies.empty()) return;
  const double largest = largest_courant(config);
  if (!in.given("time_courant"))
    config.time.courant = standard_courant(config);
  else if (config.time.courant > largest)
    in.reject("time_courant", formatted("at most %.4g, by the particles along a cell's edge and the damping: "
                                        "above it the rim of a body is "
                                        "not stable",
                                        largest));
}

void read_physics(OptionReader& in, Config& config) {
  in.section("Physics");
  read_forces(in, config);
  read_analysis(in, config);
  read_velocity_update(in, config);
  in.word({.name = "particle_domain",
           .meaning = "how the domains of particles follow the soil: fixed: not at all; stretch: each "
                      "particle has half lengths along the axes that follow its deformation, from 0.1 to 0.5 "
                      "cells; split: that, and particles whose domains become too long are split, and those "
                      "that crowd are merged again",
           .standard = in.listing() ? "fixed, or split with -analysis flow" : ""},
          Words<ParticleDomain>{{"fixed", ParticleDomain::fixed},
                                {"stretch", ParticleDomain::stretch},
                                {"split", ParticleDomain::split}},
          config.particle_domain);
  read_position_correction(in, config);
  in.word(
      {.name = "stray_particles",
       .meaning =
           "what becomes of particles that are alone, or whose volume leaves 0.2 to 2 times that at the "
           "start: keep: alone they carry no stress, and the volume stays at the bound; remove: they "
           "leave the run; stop: the run ends with exit status 3",
       .change = k_at_stages},
      Words<StrayRule>{{"keep", StrayRule::keep}, {"remove", StrayRule::remove}, {"stop", StrayRule::stop}},
      config.stray_particles);
  in.number(
      {.name = "f_bar_fraction",
       .meaning = "fraction of the cell's mean in a particle's dilatation (F-bar), against locking, of all "
                  "materials without an f_bar_fraction of their own; by default a material with a "
                  "dilation_deg above 0 has 0",
       .unit = "-",
       .range = {.lowest = 0, .highest = 1},
       .change = k_at_stages},
      config.f_bar_fraction);
  note_analysis(in, config);
}

}  // namespace mpm
