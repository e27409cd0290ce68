// Options of the sides of the mesh beside their kind.

#include <algorithm>
#include <cmath>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/files/acceleration_record.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr const char* k_motion_keys[] = {"velocity",
                                         "velocity_table",
                                         "velocity_table_interpolation",
                                         "acceleration",
                                         "acceleration_table",
                                         "acceleration_table_interpolation",
                                         "acceleration_correction"};

/// Calls f("_KEY") for each option of a side.
template <class F>
void for_each_key(F&& f) {
  for (const SideNumber& number : k_side_numbers) f(std::string("_") + number.key);
  for (const char* key : k_motion_keys) f(std::string("_") + key);
}

/// Whether a side is a friction side without friction.
bool is_smooth(const OptionReader& in, const std::string& name) {
  return lower_case(in.given_text(name)) == "smooth";
}

/// Words of the kinds of side for which f holds.
template <class F>
std::vector<std::string> words_where(F&& f) {
  std::vector<std::string> words;
  for (const SideWord& side : k_side_words)
    if (f(side)) words.emplace_back(side.word);
  return words;
}

void read_numbers(OptionReader& in, const std::string& name, Wall kind, SideNumbers& numbers) {
  for (const SideNumber& number : k_side_numbers)
    if (const auto only = in.where(name, words_where([&](const SideWord& side) {
                                     return number.of(side.kind) && std::string(side.word) != "smooth";
                                   }));
        in.listing() || (number.of(kind) && !is_smooth(in, name)))
      in.number({.name = name + "_" + number.key,
                 .meaning = number.meaning,
                 .unit = number.unit,
                 .range = {.lowest = 0, .highest = number.highest, .open_lowest = number.positive},
                 .required = number.required,
                 .standard = number.standard,
                 .change = k_by_choice},
                numbers.*number.member);
}

void read_velocity(OptionReader& in, const std::string& name, int dim, double end, SideConfig& side) {
  const Option velocity{.name = name + "_velocity",
                        .meaning =
                            "velocity of the side, which stays where it is; absorbing: of what the "
                            "dashpots hold on to",
                        .unit = "m/s",
                        .range = k_speed,
                        .change = k_by_choice};
  in.vector(velocity, dim, side.velocity);
  read_timed(in, velocity, true, dim, end, side.velocity, side.velocity_table);
  if (side.velocity_table) side.velocity = largest_of(*side.velocity_table);
  side.moves = side.velocity != Vec3{};
  if (!side.moves) side.velocity_table.reset();  // of zeros
}

/// Puts the velocities of a record in lieu of its accelerations.
void take_record(OptionReader& in, const std::string& name, int dim, BaselineCorrection correction,
                 const TimeTable& record, SideConfig& side) {
  IntegratedRecord integrated = integrate(record, correction);
  side.velocity = largest_of(integrated.velocities);
  side.of_accelerations = true;
  for (const double v : side.velocity)
    if (!k_speed.holds(v)) return in.reject(name, "accelerations of velocities" + k_speed.text() + " m/s");
  in.note(name, report_of(integrated, correction, dim));
  side.moves = side.velocity != Vec3{};
  if (side.moves) side.velocity_table = std::move(integrated.velocities);
}

/// A corrected record may end before the run: the side is then at rest.
void read_acceleration(OptionReader& in, const std::string& name, int dim, double end, SideConfig& side) {
  const auto acceleration = [&](const std::string& meaning) {
    return Option{.name = name + "_acceleration",
                  .meaning = meaning,
                  .unit = "m/s2",
                  .range = k_speed,
                  .change = k_by_choice};
  };
  const std::string table = name + "_acceleration_table", word = name + "_acceleration_correction";
  Vec3 size{};
  BaselineCorrection correction = BaselineCorrection::linear;
  if (const auto only = in.where(table); in.given(table) || in.listing()) {
    in.vector(acceleration("what the factors of -" + table + " multiply"), dim, size);
    in.word(
        {.name = word,
         .meaning = "what is taken out of the velocities that the record integrates to: nothing; linear: a "
                    "straight line, so that they end at zero; quadratic: a parabola, so that the "
                    "displacements do so too",
         .change = k_by_choice},
        Words<BaselineCorrection>{{"none", BaselineCorrection::none},
                                  {"linear", BaselineCorrection::linear},
                                  {"quadratic", BaselineCorrection::quadratic}},
        correction);
  }
  std::optional<TimeTable> record;
  read_timed(in, acceleration("record of accelerations of the side, which moves by their integral"), true,
             dim, correction == BaselineCorrection::none ? end : 0, size, record);
  if (record) take_record(in, table, dim, correction, *record, side);
}

/// A roller leaves the velocity along it to the soil.
void check_roller(OptionReader& in, const std::string& name, int dim, int d, const SideConfig& side) {
  const std::string axis(1, "xyz"[d]);
  for (int k = 0; k < dim; ++k)
    if (k != d && side.velocity[k] != 0)
      return in.reject(name + motion_of(side), "0 but in " + axis + ", for -" + name +
                                                   " is roller, which leaves the velocity along it free");
}

/// Why a side does not take an option. moves: sides of its kind may move.
std::string why_not(const OptionReader& in, const std::string& name, const std::string& key, bool moves) {
  const std::string table = name + "_acceleration_table", word = in.given_text(name);
  if (moves && key.starts_with("_velocity") && in.given(table)) return "the side moves by -" + table;
  if (moves && key.starts_with("_acceleration")) return "there is no -" + table;
  return "-" + name + " is " + (word.empty() ? "roller" : lower_case(word));
}

void read_side(OptionReader& in, const Config& config, int d, int side, SideConfig& to) {
  const std::string name = side_option(d, side);
  const Wall kind = config.mesh.walls[d][side];
  const auto known = in.known().size();
  read_numbers(in, name, kind, to.numbers);
  if (const auto only =
          in.where(name, words_where([](const SideWord& side) { return side.kind != Wall::periodic; }));
      true)
    read_side_water(in, name, kind, to);
  const bool moves = may_move(kind);
  const auto only = in.where(name, words_where([](const SideWord& side) { return may_move(side.kind); }));
  if (const auto alone = in.unless(name + "_acceleration_table");
      in.listing() || (moves && !in.given(name + "_acceleration_table")))
    read_velocity(in, name, config.dim, config.time.end, to);
  if (in.listing() || moves) read_acceleration(in, name, config.dim, config.time.end, to);
  if (in.listing()) return;
  const auto& all = in.known();
  for_each_key([&](const std::string& key) {
    if (std::find(all.begin() + static_cast<long>(known), all.end(), name + key) == all.end())
      in.not_taken(name + key, why_not(in, name, key, moves));
  });
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
    in.settle(
        name, "roller",
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
      if (const auto only = d == 2 ? in.where("dim", {"3"}) : in.always(); d < config.dim || in.listing()) {
        read_side(in, config, d, side, config.mesh.sides[d][side]);
      } else {
        for_each_key([&](const std::string& key) {
          in.not_taken(side_option(d, side) + key, "a mesh in 2D has no such side");
        });
        in.not_taken(side_option(d, side) + "_water", "a mesh in 2D has no such side");
      }
}

namespace {

/// Checks that columns of the free field stand on a base, which holds them.
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
                               " has no Poisson's ratio, which determines the speed of its shear waves");
    }
}

}  // namespace mpm
