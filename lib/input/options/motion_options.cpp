// Motion of a rigid body: each kind takes its own options.

#include <algorithm>

#include "common/time_table.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

const Words<Motion> k_motions = {
    {"fixed", Motion::fixed}, {"prescribed", Motion::prescribed}, {"dynamic", Motion::dynamic}};

/// The options that some motion takes, without the name of the rigid.
constexpr const char* k_motion_keys[] = {"velocity",
                                         "velocity_table",
                                         "displacement_table",
                                         "velocity_table_interpolation",
                                         "density",
                                         "displacement_table_interpolation",
                                         "force",
                                         "force_table",
                                         "force_table_interpolation"};

/// A prescribed velocity, constant or in time, or a displacement in time.
void read_prescribed(OptionReader& in, int dim, double end, const Option& velocity, RigidConfig& rigid) {
  const std::string displaced = rigid.name + "_displacement_table";
  Option required = velocity;
  required.required = !in.listing() && !in.given(velocity.name + "_table") && !in.given(displaced) &&
                      !in.given(rigid.name + "_angular_velocity") &&
                      !in.given(rigid.name + "_angular_velocity_table") &&
                      !in.given(rigid.name + "_angle_table");
  {
    const auto only = in.where(rigid.name + "_motion", {"prescribed", "dynamic"});
    in.vector(required, dim, rigid.velocity);
  }
  const auto only = in.where(rigid.name + "_motion", {"prescribed"});
  read_timed(in, velocity, true, dim, end, rigid.velocity, rigid.velocity_table);
  read_timed(in,
             {.name = rigid.name + "_displacement",
              .meaning = "prescribed: its displacement since the start, whose changes move it",
              .unit = "m",
              .range = k_coordinate,
              .change = k_by_choice},
             false, dim, end, {}, rigid.displacement_table);
  if (!in.listing() && in.given(displaced))
    for (const std::string& other : {velocity.name, velocity.name + "_table"})
      if (in.given(other)) in.reject(other, "nothing beside -" + displaced);
  if (rigid.velocity_table) rigid.velocity = largest_of(*rigid.velocity_table);
  if (rigid.displacement_table) rigid.velocity = largest_rate(*rigid.displacement_table);
}

void read_dynamic(OptionReader& in, int dim, double end, RigidConfig& rigid) {
  const Option density{.name = rigid.name + "_density",
                       .meaning = "dynamic: its density",
                       .unit = "kg/m3",
                       .range = k_density,
                       .required = !in.given(rigid.name + "_mass"),
                       .change = k_by_choice};
  const auto only = in.where(rigid.name + "_motion", {"dynamic"});
  if (const auto alone = in.unless(rigid.name + "_mass");
      in.number(density, rigid.density) && !density.required)
    in.reject(density.name, "nothing beside -" + rigid.name + "_mass");
  const Option force{.name = rigid.name + "_force",
                     .meaning = "dynamic: external force on it, beside gravity",
                     .unit = "N",
                     .range = k_stress,
                     .change = k_by_choice};
  in.vector(force, dim, rigid.force);
  read_timed(in, force, true, dim, end, rigid.force, rigid.force_table);
}

}  // namespace

void read_motion(OptionReader& in, int dim, double end, RigidConfig& rigid) {
  const auto errors = in.errors();
  in.word({.name = rigid.name + "_motion",
           .meaning = "none, by its velocity, or by its density, force and gravity",
           .change = k_by_choice},
          k_motions, rigid.motion);
  const auto known = in.known().size();
  const bool sound = in.errors() == errors;
  if (sound) {
    const bool prescribed = rigid.motion == Motion::prescribed, dynamic = rigid.motion == Motion::dynamic;
    const Option velocity{.name = rigid.name + "_velocity",
                          .meaning = "prescribed: its velocity (required); dynamic: its initial velocity",
                          .unit = "m/s",
                          .range = k_speed,
                          .change = k_by_choice};
    if (prescribed || in.listing()) read_prescribed(in, dim, end, velocity, rigid);
    if (dynamic) in.vector(velocity, dim, rigid.velocity);
    if (dynamic || in.listing()) read_dynamic(in, dim, end, rigid);
    if (rigid.motion != Motion::fixed || in.listing()) read_turning(in, dim, end, rigid);
    if (dynamic || in.listing()) read_support(in, dim, rigid);
  }
  const std::string why = rigid.name + "_motion is " + k_motions[static_cast<int>(rigid.motion)].first;
  std::vector<std::string> keys(std::begin(k_motion_keys), std::end(k_motion_keys));
  for (const auto* more : {&turning_keys(), &support_keys()})
    keys.insert(keys.end(), more->begin(), more->end());
  for (const std::string& key : keys) {
    const std::string name = rigid.name + "_" + key;
    const auto& all = in.known();
    if (!sound)
      in.ignore(name);
    else if (std::find(all.begin() + static_cast<long>(known), all.end(), name) == all.end())
      in.not_taken(name, why);
  }
}

void check_cut_motion(OptionReader& in, const MeshConfig& mesh, int dim, const RigidConfig& rigid) {
  const Cuts cuts = cuts_of(rigid.shape, mesh, dim);
  const std::string option = rigid.name + (rigid.displacement_table ? "_displacement_table"
                                           : rigid.velocity_table   ? "_velocity_table"
                                                                    : "_velocity");
  for (int d = 0; d < dim; ++d)
    if ((cuts[d][0] || cuts[d][1]) && rigid.velocity[d] != 0)
      return in.reject(option, std::string(rigid.displacement_table ? "no change in " : "0 in ") + "xyz"[d] +
                                   ", across the plane of symmetry that cuts the shape");
}

}  // namespace mpm
