// What sides of the mesh take beside their kind.

#include <algorithm>
#include <cmath>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/groups.hpp"
#include "input/shapes.hpp"

namespace mpm {
namespace {

constexpr const char* k_keys[] = {"_friction",
                                  "_shear_limit",
                                  "_dashpot_factor",
                                  "_spring_length",
                                  "_velocity",
                                  "_velocity_table",
                                  "_velocity_table_interpolation"};

/// Whether a side is a friction side without friction.
bool is_smooth(const OptionReader& in, const std::string& name) {
  return lower_case(in.given_text(name)) == "smooth";
}

void read_friction(OptionReader& in, const std::string& name, SideConfig& side) {
  if (is_smooth(in, name)) return;
  in.number({.name = name + "_friction",
             .meaning = "friction: coefficient of friction, tan of the angle",
             .unit = "-",
             .range = {.lowest = 0, .highest = 1e3},
             .required = true},
            side.friction);
  in.number({.name = name + "_shear_limit",
             .meaning = "friction: largest shear stress along the side",
             .unit = "Pa",
             .range = {.lowest = 0, .highest = 1e15},
             .standard = "none"},
            side.shear_limit);
}

void read_absorbing(OptionReader& in, const std::string& name, SideConfig& side) {
  in.number({.name = name + "_dashpot_factor",
             .meaning = "absorbing, free_field: factor of the dashpots rho c",
             .unit = "-",
             .range = {.lowest = 0, .highest = 1e3}},
            side.dashpot_factor);
  in.number(
      {.name = name + "_spring_length",
       .meaning = "absorbing, free_field: length L of springs rho c^2 / L beside the dashpots, against drift",
       .unit = "m",
       .range = {.lowest = 0, .highest = 1e9, .open_lowest = true},
       .standard = "no springs"},
      side.spring_length);
}

void read_velocity(OptionReader& in, const std::string& name, int dim, double end, SideConfig& side) {
  const Option velocity{.name = name + "_velocity",
                        .meaning =
                            "velocity of the side, which stays where it is; absorbing: of what the "
                            "dashpots hold on to",
                        .unit = "m/s",
                        .range = k_speed};
  in.vector(velocity, dim, side.velocity);
  read_timed(in, velocity, true, dim, end, side.velocity, side.velocity_table);
  if (side.velocity_table) side.velocity = largest_of(*side.velocity_table);
  side.moves = side.velocity != Vec3{};
}

/// A roller leaves the velocity along it to the soil.
void check_roller(OptionReader& in, const std::string& name, int dim, int d, const SideConfig& side) {
  for (int k = 0; k < dim; ++k)
    if (k != d && side.velocity[k] != 0)
      return in.reject(name + (side.velocity_table ? "_velocity_table" : "_velocity"),
                       std::string("0 but in ") + "xyz"[d] + ", for -" + name +
                           " is roller, which leaves the velocity along it free");
}

void read_side(OptionReader& in, const Config& config, int d, int side, SideConfig& to) {
  const std::string name = side_option(d, side);
  const Wall kind = config.mesh.walls[d][side];
  const auto known = in.known().size();
  if (kind == Wall::friction || in.listing()) read_friction(in, name, to);
  if (has_dashpots(kind) || in.listing()) read_absorbing(in, name, to);
  if ((!is_open(kind) && kind != Wall::free_field) || in.listing())
    read_velocity(in, name, config.dim, config.time.end, to);
  if (in.listing()) return;
  const std::string word = in.given_text(name);
  const auto& all = in.known();
  for (const char* key : k_keys)
    if (std::find(all.begin() + static_cast<long>(known), all.end(), name + key) == all.end())
      in.not_taken(name + key, "-" + name + " is " + (word.empty() ? "roller" : lower_case(word)));
  if (kind == Wall::roller) check_roller(in, name, config.dim, d, to);
}

}  // namespace

namespace {

/// Whether a body reaches a side of the mesh where it begins.
bool reaches_side(const Config& config, int d, int side) {
  const double slack = 1e-6 * config.mesh.spacing;
  return std::any_of(config.bodies.begin(), config.bodies.end(), [&](const BodyConfig& body) {
    const Bounds bounds = bounds_of(body.shape, config.mesh, config.dim);
    return side == 0 ? bounds.lower[d] <= config.mesh.lower[d] + slack
                     : bounds.upper[d] >= config.mesh.upper[d] - slack;
  });
}

}  // namespace

void choose_lid(OptionReader& in, const Config* before, Config& config) {
  if (in.listing()) return;
  int d = 0;
  for (int k = 1; k < config.dim; ++k)
    if (std::abs(config.gravity[k]) >= std::abs(config.gravity[d])) d = k;
  const int side = config.gravity[d] < 0 ? 1 : 0;
  const std::string name = side_option(d, side);
  Wall& wall = config.mesh.walls[d][side];
  if (config.gravity[d] == 0 || in.given(name) || wall != Wall::roller || config.mesh.sides[d][side].moves)
    return;
  if (before ? before->mesh.walls[d][side] == Wall::roller : reaches_side(config, d, side)) {
    in.settle(name, "roller",
              "roller by default where soil reaches this side at the start, and holds it in tension too, as a "
              "plane of symmetry does; smooth or free lets the soil go");
  } else {
    wall = Wall::friction;
    in.settle(name, "smooth", "");
  }
}

void read_sides(OptionReader& in, Config& config) {
  in.section("Sides of the mesh");
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side)
      if (d < config.dim || in.listing()) {
        read_side(in, config, d, side, config.mesh.sides[d][side]);
      } else {
        for (const char* key : k_keys)
          in.not_taken(side_option(d, side) + key, "a mesh in 2D has no such side");
      }
}

namespace {

/// Columns of the free field stand on a base that tells how they are held.
void check_columns(OptionReader& in, const Config& config, int d, int side) {
  const int vertical = config.dim - 1;
  const std::string name = side_option(d, side), base = side_option(vertical, 0);
  if (d == vertical)
    return in.reject(name,
                     "another kind of side: columns of the free field stand beside sides that are not "
                     "normal to the vertical axis");
  const Wall below = config.mesh.walls[vertical][0];
  if (!is_mirror(below) && below != Wall::absorbing && below != Wall::free_field)
    in.reject(base, "roller, fixed or absorbing where -" + name + " is free_field");
}

}  // namespace

void check_absorbing(OptionReader& in, const Config& config) {
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!has_dashpots(config.mesh.walls[d][side])) continue;
      if (config.mesh.walls[d][side] == Wall::free_field) check_columns(in, config, d, side);
      if (config.water.level)
        in.reject(side_option(d, side), "another kind of side where -water_level is given");
      for (const MaterialConfig& material : config.materials)
        if (!shear_wave_ratio(material))
          return in.reject(side_option(d, side),
                           "another kind of side where material " + material.name +
                               " has no Poisson's ratio, which tells the speed of its shear waves");
    }
}

}  // namespace mpm
