#include "check/warnings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "check/alike.hpp"
#include "check/warnings_choices.hpp"
#include "check/warnings_rigids.hpp"
#include "check/warnings_soil.hpp"
#include "common/f_bar.hpp"
#include "common/material_table.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/geometry/shapes.hpp"
#include "input/geometry/thickness.hpp"
#include "input/options/groups.hpp"
#include "step/stepper.hpp"

namespace mpm {
namespace {

using Lines = std::vector<std::string>;

double length_of(const Vec3& x) { return std::hypot(x[0], x[1], x[2]); }

/// Whether a shape reaches a side of the mesh: what is beyond meets no soil.
bool reaches(const Config& config, const Bounds& bounds, int d, int side) {
  const double slack = 1e-6 * config.mesh.spacing;
  return side == 0 ? bounds.lower[d] <= config.mesh.lower[d] + slack
                   : bounds.upper[d] >= config.mesh.upper[d] - slack;
}

void warn_of_gravity(const Config& config, Lines& lines) {
  const int up = config.dim - 1;
  if (!(config.gravity[up] > 0)) return;
  Vec3 down = config.gravity;
  down[up] = -down[up];
  const char* option = config.gravity_table ? "-gravity_table" : "-gravity";
  lines.push_back(std::string("warning: ") + option + ": given \"" + text_of(config.gravity, config.dim) +
                  "\" points upward; the vertical axis is " + "xyz"[up] + ", so that weight is \"" +
                  text_of(down, config.dim) + "\"");
}

/// Water that reaches no soil, and soil that it lifts.
void warn_of_water(const Config& config, Lines& lines) {
  if (!config.water.level) return;
  bool reaches_soil = false;
  for (const BodyConfig& body : config.bodies) {
    if (body.shape.kind == ShapeKind::particles) return;  // where they are is in their file
    const MaterialConfig& material = config.materials[body.material];
    const bool below = heights_of(body.shape, config)[0] < *config.water.level;
    reaches_soil = reaches_soil || below;
    if (below && material.density < config.water.density)
      lines.push_back(formatted(
          "warning: -%s_density: %g kg/m3 is less than that of the water, so that body %s rises; soil below "
          "the water has the density of grains and pore water together",
          material.name.c_str(), material.density, body.name.c_str()));
  }
  if (!reaches_soil)
    lines.push_back(formatted("warning: -water_level: %g m is below all soil", *config.water.level));
}

void warn_of_tension(const BodyConfig& body, int dim, Lines& lines) {
  if (std::max({body.stress[0], body.stress[1], body.stress[2]}) > 0)
    lines.push_back("warning: -" + body.name + "_stress: given \"" +
                    text_of(std::span(body.stress).first(dim == 2 ? 4 : 6)) +
                    "\" is tensile; compression, as under weight, is negative");
}

/// Soil of Young's modulus [Pa] and strength [Pa] at the foot of a body; NaN where the model has none.
struct Stiffness {
  double young, strength;

  Stiffness(const MaterialConfig& material, double foot)
      : young(parameter_of(material, "young")), strength(parameter_of(material, "su")) {
    const double gradient = parameter_of(material, "su_gradient"), datum = parameter_of(material, "su_datum"),
                 rigidity = parameter_of(material, "rigidity");
    if (parameter_of(material, "su_ratio") > 0) strength = std::numeric_limits<double>::quiet_NaN();
    if (gradient > 0) strength += gradient * std::max(0.0, datum - foot);
    if (rigidity > 0) young = rigidity * strength;
    const double growth = parameter_of(material, "young_gradient"),
                 level = parameter_of(material, "young_datum");
    if (growth > 0) young += growth * std::max(0.0, level - foot);
    if (young < 0) young = std::numeric_limits<double>::quiet_NaN();  // each particle's own
  }
};

void warn_of_rigidity(const std::string& material, const Stiffness& soil, Lines& lines) {
  constexpr double k_lowest = 10, k_highest = 1e5;
  if (!(soil.young > k_highest * soil.strength || soil.young < k_lowest * soil.strength)) return;
  lines.push_back(formatted(
      "warning: material %s: Young's modulus is %.4g times the strength (%.4g and %.4g Pa); for clay it "
      "is 50 to 2000 times, so check -%s_young and -%s_su",
      material.c_str(), soil.young / soil.strength, soil.young, soil.strength, material.c_str(),
      material.c_str()));
}

/// Densities in t/m3 or kN/m3, moduli in kPa.
void warn_of_units(const Config& config, const MaterialConfig& material, const Stiffness& soil, double height,
                   Lines& lines) {
  constexpr double k_tonnes_least = 0.5, k_unit_weight_most = 30, k_soil = 500, k_softest = 2e4;
  const double gravity = length_of(config.gravity), weight = material.density * gravity * height;
  const bool clay = soil.strength > 0, on_earth = gravity > 1;
  if (material.density >= k_tonnes_least && material.density < k_unit_weight_most && (clay || on_earth))
    lines.push_back(formatted(
        "warning: -%s_density: %g kg/m3 looks like t/m3 or kN/m3; all input is in SI units: kg, m, s, Pa",
        material.name.c_str(), material.density));
  else if (soil.young < weight)
    lines.push_back(formatted(
        "warning: material %s: Young's modulus, %.4g Pa, is less than the stress of its own weight, %.4g "
        "Pa; is it given in kPa?",
        material.name.c_str(), soil.young, weight));
  else if (clay && material.density >= k_soil && soil.young < k_softest)
    lines.push_back(
        formatted("warning: material %s: Young's modulus, %.4g Pa, is that of jelly; is it given in kPa?",
                  material.name.c_str(), soil.young));
}

/// rigid: the name of a rigid body, or of a part of one.
void warn_of_thin(const Config& config, const std::string& rigid, const Shape& shape, Lines& lines) {
  constexpr double k_least = 3;  // cells
  for (std::size_t n = 0; n < shape.parts.size(); ++n)
    warn_of_thin(config, shape.part_names[n], shape.parts[n], lines);
  if (shape.kind == ShapeKind::half_plane || shape.kind == ShapeKind::parts) return;
  const double across = narrowest(shape, config.mesh, config.dim), cells = across / config.mesh.spacing;
  if (cells < k_least * (1 - 1e-6)) {
    lines.push_back(
        formatted("warning: rigid %s is %.4g m across, %.3g times a cell; soil may pass through what is "
                  "thinner than %g "
                  "cells: take smaller cells, or make it thicker away from the soil",
                  rigid.c_str(), across, cells, k_least));
    return;
  }
  if (shape.kind != ShapeKind::stl) return;
  if (const auto thin = thinnest_twentieth(*shape.triangles, k_least * config.mesh.spacing))
    lines.push_back(
        formatted("warning: a twentieth of the surface of rigid %s or more is %.3g m thick or less, as at "
                  "%s, %.2g times a cell; soil "
                  "may pass through what is thinner than %g cells: take smaller cells",
                  rigid.c_str(), thin->value, text_of(thin->place, 3).c_str(),
                  thin->value / config.mesh.spacing, k_least));
}

/// The option that makes a rigid move, without the rigid's name.
const char* option_of_motion(const RigidConfig& rigid) {
  return rigid.displacement_table ? "displacement_table"
         : rigid.velocity_table   ? "velocity_table"
                                  : "velocity";
}

/// A speed that adds inertia to the resistance: of pressure waves, or of shear waves, which in undrained clay
/// are several times slower.
void warn_of_speed(const Config& config, const RigidConfig& rigid, Lines& lines) {
  constexpr double k_most = 0.01, k_most_of_shear = 0.05;
  if (rigid.motion != Motion::prescribed) return;
  double slowest = std::numeric_limits<double>::infinity(), shear = slowest;
  for (const BodyConfig& body : config.bodies) {
    const MaterialConfig& material = config.materials[body.material];
    const double wave = wave_speed(config, body),
                 water = material.saturated() ? config.water.bulk_modulus / material.pores.porosity
                                              : material.pore_stiffness,
                 pore = water / density_of(config, body);
    slowest = std::min(slowest, wave);
    if (const auto ratio = shear_wave_ratio(material); ratio && *ratio > 0)
      shear = std::min(shear, *ratio * std::sqrt(std::max(0.0, wave * wave - pore)));
  }
  const double speed = length_of(rigid.velocity);
  const bool by_shear = speed <= k_most * slowest && speed > k_most_of_shear * shear;
  if (speed <= k_most * slowest && !by_shear) return;
  const double waves = by_shear ? shear : slowest;
  lines.push_back(formatted(
      "warning: -%s_%s: %.4g m/s is %.2g %% of the speed of %swaves in the soil, %.4g m/s; above %g %% "
      "inertia adds to the resistance",
      rigid.name.c_str(), option_of_motion(rigid), speed, 100 * speed / waves, by_shear ? "shear " : "",
      waves, 100 * (by_shear ? k_most_of_shear : k_most)));
}

/// Whether soil is where the rigid goes, along direction d, by the end of the run.
bool penetrates(const Config& config, const RigidConfig& rigid, Bounds bounds, int d) {
  const double way = travel(rigid, d, config.time.end), slack = 1e-6 * config.mesh.spacing;
  (way > 0 ? bounds.upper : bounds.lower)[d] += way;
  return std::any_of(config.bodies.begin(), config.bodies.end(), [&](const BodyConfig& body) {
    const Bounds soil = bounds_of(body.shape, config.mesh, config.dim);
    for (int k = 0; k < config.dim; ++k)
      if (std::min(bounds.upper[k], soil.upper[k]) - std::max(bounds.lower[k], soil.lower[k]) < slack)
        return false;
    return true;
  });
}

/// Whether soil lies at a side of the mesh that is a wall.
bool is_wall(const Config& config, int d, int side) {
  return !is_open(config.mesh.walls[d][side]) && !has_dashpots(config.mesh.walls[d][side]) &&
         std::any_of(config.bodies.begin(), config.bodies.end(), [&](const BodyConfig& body) {
           return reaches(config, bounds_of(body.shape, config.mesh, config.dim), d, side);
         });
}

/// Warns of walls beside the way of a rigid that penetrates, by the nearest wall. A wall that the rigid
/// reaches is a plane of symmetry: it is the rigid's middle.
void warn_of_walls(const Config& config, const RigidConfig& rigid, const Bounds& bounds, Lines& lines) {
  constexpr double k_least = 3;  // widths, from the middle
  if (rigid.motion == Motion::fixed || length_of(rigid.velocity) == 0) return;
  int ahead = 0;
  for (int d = 1; d < config.dim; ++d)
    if (std::abs(rigid.velocity[d]) > std::abs(rigid.velocity[ahead])) ahead = d;
  if (!penetrates(config, rigid, bounds, ahead)) return;
  double nearest = k_least * (1 - 1e-6), width_there = 0;
  std::string where;
  for (int d = 0; d < config.dim; ++d) {
    const bool at[2] = {reaches(config, bounds, d, 0), reaches(config, bounds, d, 1)};
    if (d == ahead || (at[0] && at[1])) continue;
    const double extent = bounds.upper[d] - bounds.lower[d], width = extent * (at[0] || at[1] ? 2 : 1);
    const double middle = at[0]   ? bounds.lower[d]
                          : at[1] ? bounds.upper[d]
                                  : (bounds.lower[d] + bounds.upper[d]) / 2;
    for (int side = 0; side < 2; ++side) {
      const double away = std::abs((side == 0 ? config.mesh.lower : config.mesh.upper)[d] - middle) / width;
      if (at[side] || !is_wall(config, d, side) || away >= nearest) continue;
      nearest = away, width_there = width;
      where = side_option(d, side);
    }
  }
  if (!where.empty())
    lines.push_back(formatted(
        "warning: the middle of rigid %s is %.3g of its widths (%.4g m) from the wall %s; nearer than %g the "
        "wall adds to its resistance",
        rigid.name.c_str(), nearest, width_there, where.c_str(), k_least));
}

void warn_of_f_bar(const Config& config, const MaterialConfig& material, Lines& lines) {
  const double fraction = f_bar_fraction(config, material);
  if (!(fraction > 0 && parameter_of(material, "dilation_deg") > 0)) return;
  const std::string own = material.f_bar_fraction ? material.name + "_" : "";
  lines.push_back(
      formatted("warning: -%sf_bar_fraction: given \"%g\", creates energy in %s, which dilates as it yields; "
                "0 does not",
                own.c_str(), fraction, material.name.c_str()));
}

}  // namespace

std::vector<std::string> warnings_of(const Config& config, int ranks) {
  Lines lines;
  if (!config.element.file.empty()) {  // a single point, of one material and no body
    for (const std::string& line : warnings_of_law(config.materials[0])) lines.push_back("warning: " + line);
    return lines;
  }
  if (ranks == 1 && config.partition.halo_path != HaloPath::automatic)
    lines.push_back("warning: -halo_path: not used on one rank, which has no halo");
  warn_of_gravity(config, lines);
  warn_of_water(config, lines);
  for (const std::string& line : warnings_of_excavations(config)) lines.push_back(line);
  for (const std::string& line : warnings_of_pairs(config)) lines.push_back(line);
  for (const std::string& line : warnings_of_pores(config)) lines.push_back(line);
  std::vector<char> warned(config.materials.size());
  for (const BodyConfig& body : config.bodies) {
    warn_of_tension(body, config.dim, lines);
    const int up = config.dim - 1;
    const Bounds bounds = bounds_of(body.shape, config.mesh, config.dim);
    const MaterialConfig& material = config.materials[body.material];
    const Stiffness soil(material, bounds.lower[up]);
    if (warned[body.material]) continue;
    warned[body.material] = 1;
    for (const std::string& line : warnings_of_law(material)) lines.push_back("warning: " + line);
    warn_of_f_bar(config, material, lines);
    warn_of_rigidity(material.name, soil, lines);
    warn_of_units(config, material, soil, bounds.upper[up] - bounds.lower[up], lines);
  }
  for (const RigidConfig& rigid : config.rigids) {
    const Bounds bounds = bounds_of(rigid.shape, config.mesh, config.dim);
    warn_of_thin(config, rigid.name, rigid.shape, lines);
    warn_of_speed(config, rigid, lines);
    warn_of_walls(config, rigid, bounds, lines);
  }
  for (const std::string& line : warnings_of_rigids(config)) lines.push_back(line);
  for (const std::string& line : warnings_of_choices(config)) lines.push_back(line);
  return without_alike(lines);
}

}  // namespace mpm
