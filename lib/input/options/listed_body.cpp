// A body from a file that lists its particles, and from options.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "common/material_table.hpp"
#include "common/revolution.hpp"
#include "common/text.hpp"
#include "input/options/groups.hpp"
#include "output/own_files.hpp"

namespace mpm {
namespace {

/// Whether the run would remove a file, with the frames and checkpoints that are in its folder.
bool will_be_removed(const std::string& file, const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code none;
  const fs::path path = fs::weakly_canonical(file, none), own = fs::weakly_canonical(folder, none);
  const std::string name = path.filename().string();
  return (path.parent_path() == own && is_written_name(name, false)) ||
         (path.parent_path() == own / "frames" && is_written_name(name, true));
}

/// Largest magnitude of the numbers of a column.
double most_of(Bound bound, const Config& config, const MeshConfig& mesh) {
  constexpr double k_largest_domain = 1e12;  // cells2
  const double cell = std::pow(mesh.spacing, config.dim) * revolved_length(config, mesh.upper[0]);
  switch (bound) {
    case Bound::none: break;
    case Bound::speed: return k_speed.highest;
    case Bound::stress: return k_stress.highest;
    case Bound::volume: return 10 * cell;
    case Bound::mass: return 10 * cell * k_density.highest;
    case Bound::coordinate: return k_coordinate.highest;
    case Bound::domain: return k_largest_domain;
  }
  return std::numeric_limits<double>::infinity();
}

/// Particles with numbers for which the arithmetic has room, as the end of "takes ..."; empty where all are.
std::string beyond_bounds(const ParticleTable& table, const Config& config, const MeshConfig& mesh) {
  constexpr double k_largest_state = 1e12;  // whatever its unit
  const auto fault_of = [](const char* name, const std::vector<double>& values, int width, double most) {
    for (std::size_t n = 0; n < values.size(); ++n)
      if (!(std::abs(values[n]) <= most))
        return std::string("particles whose ") + name + " is at most " + text_of(most) +
               "; that of particle " + std::to_string(n / width) + " is " + text_of(values[n]);
    return std::string();
  };
  std::string fault;
  for (const ParticleColumn& column : k_particle_columns)
    if (fault.empty() && column.bound != Bound::none)
      fault = fault_of(column.name, table.*column.values, width_of(column.width, config.dim, 0),
                       most_of(column.bound, config, mesh));
  for (const StateField& state : table.state)
    if (fault.empty()) fault = fault_of(state.name.c_str(), state.values, 1, k_largest_state);
  return fault;
}

/// Fault of a file that lacks each particle's own Young's modulus where the material asks for it; empty
/// otherwise.
std::string missing_young(const BodyConfig& body, const Config& config, const ParticleTable& table) {
  if (body.material >= static_cast<int>(config.materials.size())) return "";  // reported
  const MaterialConfig& material = config.materials[body.material];
  for (const StateField& own : table.own_parameters)
    if (own.name == "young") return "";
  if (!needs_own_young(material)) return "";
  return "a file with " + body.shape.file_body + "/young, the modulus of each particle in Pa, where -" +
         material.name + "_young is field";
}

}  // namespace

ParticleSource source_of(const BodyConfig& body) {
  return {body.shape.file, body.shape.file_body, !body.velocity_given, !body.stress_given};
}

ParticleSource source_of(const BodyConfig& body, const Config& config) {
  ParticleSource source = source_of(body);
  if (body.material >= static_cast<int>(config.materials.size())) return source;  // reported
  const auto variables = state_variables(config.materials[body.material]);
  for (const StateVariable& variable : variables)
    if (variable.changes && variable.output) source.state.push_back(variable.name);
  source.parameters = own_parameters(variables);
  if (config.materials[body.material].has_pore_pressure()) source.state.push_back(k_excess_pore_pressure);
  return source;
}

void check_particles(OptionReader& in, const BodyConfig& body, const Config& config, const MeshConfig& mesh,
                     ParticleTable& table) {
  const std::string option = body.name + "_file";
  if (will_be_removed(body.shape.file, config.output.directory))
    return in.reject(option, "a file that this run does not remove; give another -output_dir than " +
                                 config.output.directory);
  const ParticleSource source = source_of(body, config);
  std::string fault = read_particles(source, mesh, config.dim, table);
  if (fault.empty()) fault = beyond_bounds(table, config, mesh);
  for (const auto& [key, own] : table.own_parameters)
    if (fault.empty())
      fault =
          own_parameter_fault(config.materials[body.material], key, *std::min_element(own.begin(), own.end()),
                              *std::max_element(own.begin(), own.end()));
  if (fault.empty()) fault = missing_young(body, config, table);
  if (!fault.empty()) {
    table = {};
    in.reject(option, fault);
  }
}

void check_density(OptionReader& in, const BodyConfig& body, const Config& config,
                   const ParticleTable& table) {
  // The time step is that of the material's density; with the default Courant number it is stable by 1.44.
  constexpr double k_apart = 1.25;
  if (table.position.empty() || body.material >= static_cast<int>(config.materials.size())) return;
  const MaterialConfig& material = config.materials[body.material];
  const double mean = mean_density(table, material.density), ratio = mean / material.density;
  if (!(material.density > 0) || (ratio < k_apart && ratio > 1 / k_apart)) return;
  in.reject(body.name + "_file", "particles whose mass over volume is about the density of " + material.name +
                                     ", " + text_of(material.density) + " kg/m3; together they have " +
                                     text_of(mean));
}

void read_start(OptionReader& in, int dim, BodyConfig& body) {
  const std::string from_file = "; where a file lists the particles, in lieu of theirs";
  body.velocity_given = in.vector({.name = body.name + "_velocity",
                                   .meaning = "initial velocity" + from_file,
                                   .unit = "m/s",
                                   .range = k_speed},
                                  dim, body.velocity);
  const Option stress{.name = body.name + "_stress",
                      .meaning = "initial effective stress, tension positive" + from_file +
                                 ". k0: that of level ground under the weight of the body and of the bodies "
                                 "with k0 above it",
                      .unit = "Pa",
                      .range = k_stress,
                      .aside = ", or k0",
                      .words = {"k0"}};
  if (in.given_text(stress.name) != "k0") {
    body.stress_given = in.tensor(stress, dim, body.stress);
    return;
  }
  std::string word;
  in.text(stress, word);
  body.stress_given = body.k0 = body.shape.kind != ShapeKind::particles;
  if (!body.k0) in.reject(stress.name, "numbers where a file lists the particles");
}

}  // namespace mpm
