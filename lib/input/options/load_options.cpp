// -loads: pressures and tractions on parts of bodies' surfaces.

#include <algorithm>

#include "common/presence.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr const char* k_pressure_meaning =
    "pressure into the soil along the normal of the surface, which it follows";
constexpr const char* k_traction_meaning =
    "dead load of fixed direction, by area of the surface at the start";

void read_body_of(OptionReader& in, const Config& config, LoadConfig& load) {
  std::vector<std::string> bodies;
  for (const BodyConfig& body : config.bodies) bodies.push_back(body.name);
  if (bodies.empty() && !in.listing())
    in.ignore(load.name + "_body");  // the list is wrong, which is reported
  else
    in.word({.name = load.name + "_body",
             .meaning = "the body on whose surface it is",
             .required = true,
             .aside = ", of -bodies",
             .names_of = "bodies"},
            bodies, load.body);
}

/// The box in which the surface is at the start.
void read_box(OptionReader& in, int dim, LoadConfig& load) {
  const auto errors = in.errors();
  in.vector({.name = load.name + "_lower",
             .meaning = "lower corner of a box; the load is on the free surface of the body in it when the "
                        "load begins: on "
                        "the faces of particles that no other particle covers, whose centres are in the box",
             .unit = "m",
             .range = k_coordinate,
             .required = true},
            dim, load.lower);
  in.vector({.name = load.name + "_upper",
             .meaning = "its upper corner",
             .unit = "m",
             .range = k_coordinate,
             .required = true},
            dim, load.upper);
  if (in.listing() || in.errors() != errors) return;
  for (int d = 0; d < dim; ++d)
    if (!(load.upper[d] >= load.lower[d]))
      return in.reject(load.name + "_upper", formatted("a corner above -%s_lower, \"%s\"", load.name.c_str(),
                                                       text_of(load.lower, dim).c_str()));
}

/// Stage at whose beginning the surface is found; by default the one that places the body.
void read_stage_of(OptionReader& in, const Config& config, LoadConfig& load) {
  const Option option{.name = load.name + "_stage",
                      .meaning =
                          "the stage at whose beginning the surface is found, where the soil is then, and "
                          "from which on the load acts: for faces that an excavation bares",
                      .standard = "the one that the body is in the run from",
                      .names_of = "stages"};
  int index = 0;
  if (in.listing()) {
    const auto only = in.where("stages");
    in.word(option, std::vector<std::string>{"STAGE"}, index);
    return;
  }
  if (config.stages.empty()) return in.not_taken(option.name, "the run has no stages");
  if (load.body >= static_cast<int>(config.bodies.size())) return in.ignore(option.name);
  const std::string& body = config.bodies[load.body].name;
  load.stage = std::max(1, placed_at(config.stage, body));
  index = load.stage - 1;
  if (!in.word(option, config.stages, index)) return;
  load.stage = index + 1;
  if (!is_present(config.stage, body, load.stage))
    in.reject(option.name, "a stage in which body " + body + " is in the run");
}

void read_facing(OptionReader& in, int dim, LoadConfig& load) {
  const Option option{
      .name = load.name + "_facing",
      .meaning =
          "a direction out of the body: of the faces in the box only those whose normal is within 60 "
          "degrees of it",
      .unit = "-",
      .range = k_coordinate,
      .standard = "all"};
  Vec3 facing{};
  if (!in.vector(option, dim, facing)) return;
  if (facing == Vec3{}) return in.reject(option.name, "a direction other than 0");
  load.facing = facing;
}

}  // namespace

void read_load(OptionReader& in, const Config& config, LoadConfig& load) {
  in.section("Each load NAME", {"loads"});
  const int dim = config.dim;
  read_body_of(in, config, load);
  read_stage_of(in, config, load);
  read_box(in, dim, load);
  read_facing(in, dim, load);
  const Option pressure{.name = load.name + "_pressure",
                        .meaning = k_pressure_meaning,
                        .unit = "Pa",
                        .range = k_stress,
                        .change = k_by_choice};
  const Option traction{.name = load.name + "_traction",
                        .meaning = k_traction_meaning,
                        .unit = "Pa",
                        .range = k_stress,
                        .change = k_by_choice};
  in.number(pressure, load.pressure);
  read_timed(in, pressure, true, 1, config.time.end, {load.pressure, 0, 0}, load.pressure_table);
  in.vector(traction, dim, load.traction);
  read_timed(in, traction, true, dim, config.time.end, load.traction, load.traction_table);
  const bool found =
      in.word({.name = load.name + "_on_pores",
               .meaning = "on: the pressure is that of water, which acts on the water in the pores "
                          "too; off: it passes no water, and the pores are drained there"},
              Words<bool>{{"on", true}, {"off", false}}, load.on_pores);
  if (found && load.on_pores && !in.listing() && load.body < static_cast<int>(config.bodies.size())) {
    const int material = config.bodies[load.body].material;
    if (material < static_cast<int>(config.materials.size()) && !config.materials[material].saturated())
      in.reject(load.name + "_on_pores", "off, for the water of body " + config.bodies[load.body].name +
                                             " does not flow (-NAME_water saturated of its material)");
  }
  const bool none = !in.given(pressure.name) && !in.given(pressure.name + "_table") &&
                    !in.given(traction.name) && !in.given(traction.name + "_table");
  if (none && !in.listing())
    in.reject(pressure.name, "a pressure in Pa, or -" + traction.name + " is given, or a table of either");
}

}  // namespace mpm
