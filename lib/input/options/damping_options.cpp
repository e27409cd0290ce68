// -rayleigh_*: damping by a ratio at frequencies.

#include <cmath>
#include <numbers>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

enum class RayleighParts { both, stiffness, mass };
constexpr const char* k_keys[] = {"rayleigh_frequencies", "rayleigh_parts"};

/// Ratio of critical damping at a frequency [Hz].
double ratio_at(const Config& config, double frequency) {
  const double omega = 2 * std::numbers::pi * frequency;
  return config.rayleigh_mass / (2 * omega) + config.rayleigh_stiffness * omega / 2;
}

/// alpha and beta of a ratio at one or two frequencies [Hz].
void take_ratio(RayleighParts parts, double ratio, const double* frequency, Config& config) {
  const double low = 2 * std::numbers::pi * frequency[0], high = 2 * std::numbers::pi * frequency[1];
  switch (parts) {
    case RayleighParts::both:
      config.rayleigh_mass = 2 * ratio * low * high / (low + high);
      config.rayleigh_stiffness = 2 * ratio / (low + high);
      break;
    case RayleighParts::stiffness: config.rayleigh_stiffness = 2 * ratio / low; break;
    case RayleighParts::mass: config.rayleigh_mass = 2 * ratio * low; break;
  }
}

std::string report_of(const Config& config, RayleighParts parts, const double* frequency) {
  std::string text =
      formatted("alpha = %.6g 1/s, beta = %.6g s", config.rayleigh_mass, config.rayleigh_stiffness);
  if (parts == RayleighParts::both) {
    const double middle = std::sqrt(frequency[0] * frequency[1]);
    text += formatted("; the ratio is least, %.4g, at %.4g Hz", ratio_at(config, middle), middle);
  }
  return text + formatted("; it is %.4g at %.4g Hz and %.4g at %.4g Hz", ratio_at(config, frequency[0] / 4),
                          frequency[0] / 4, ratio_at(config, 4 * frequency[1]), 4 * frequency[1]);
}

}  // namespace

void read_rayleigh(OptionReader& in, Config& config) {
  double ratio = 0;
  const std::size_t errors = in.errors();
  in.number(
      {.name = "rayleigh_ratio",
       .meaning = "Rayleigh damping: ratio of critical damping at the frequencies of -rayleigh_frequencies",
       .unit = "-",
       .range = {.lowest = 0, .highest = 0.5},
       .change = k_by_choice},
      ratio);
  if (!(ratio > 0) && !in.listing()) {
    if (in.given("rayleigh_ratio")) return in.ignore("rayleigh_");  // a stage may switch it off
    for (const char* key : k_keys) in.not_taken(key, "there is no -rayleigh_ratio");
    return;
  }
  const auto only = in.where("rayleigh_ratio");
  RayleighParts parts = RayleighParts::both;
  in.word(
      {.name = "rayleigh_parts",
       .meaning = "proportional to what Rayleigh damping is: both: to mass and stiffness, with the ratio at "
                  "two frequencies; stiffness, mass: to one alone, with the ratio at one frequency",
       .change = k_by_choice},
      Words<RayleighParts>{{"both", RayleighParts::both},
                           {"stiffness", RayleighParts::stiffness},
                           {"mass", RayleighParts::mass}},
      parts);
  double frequency[2] = {0, 0};  // Hz
  const bool two = parts == RayleighParts::both || in.listing();
  const Option frequencies{.name = "rayleigh_frequencies",
                           .meaning =
                               "frequencies at which the ratio holds: two, the lower first, or one where "
                               "-rayleigh_parts is stiffness or mass",
                           .unit = "Hz",
                           .range = {.lowest = 0, .highest = 1e6, .open_lowest = true},
                           .required = true,
                           .change = k_by_choice};
  two ? in.numbers(frequencies, "f,f", "", frequency) : in.number(frequencies, frequency[0]);
  if (in.listing() || in.errors() > errors) return;
  if (!two) frequency[1] = frequency[0];
  if (two && frequency[1] <= frequency[0])
    return in.reject("rayleigh_frequencies", "two frequencies, the lower one first");
  take_ratio(parts, ratio, frequency, config);
  in.note("rayleigh_ratio", report_of(config, parts, frequency));
}

void check_rayleigh(OptionReader& in, const Config& config) {
  if (in.listing() || !(config.rayleigh_mass > 0 || config.rayleigh_stiffness > 0)) return;
  const std::string name = "rayleigh_ratio";
  for (const MaterialConfig& material : config.materials)
    if (!shear_wave_ratio(material))
      return in.reject(name, "0 where material " + material.name +
                                 " has no Poisson's ratio, with which its stiffness would be known");
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const std::string of = side_option(d, side);
      if (config.mesh.walls[d][side] == Wall::free_field)
        return in.reject(name, "0 where -" + of + " is free_field, whose columns have no such damping");
      if (config.rayleigh_mass > 0 && config.mesh.sides[d][side].moves)
        return in.reject(name, "-rayleigh_parts stiffness where -" + of +
                                   motion_of(config.mesh.sides[d][side]) +
                                   " moves the ground: the part by mass would hold the ground back at rest; "
                                   "or shake by -gravity_table, in the frame of the base");
    }
}

}  // namespace mpm
