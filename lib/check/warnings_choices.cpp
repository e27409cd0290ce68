#include "check/warnings_choices.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "check/warnings_soil.hpp"
#include "common/f_bar.hpp"
#include "common/text.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"
#include "step/stepper.hpp"

namespace mpm {
namespace {

using Lines = std::vector<std::string>;

/// Whether a law is that of undrained clay: its strength does not depend on the mean stress.
bool is_clay(const MaterialConfig& material) {
  return material.model == "von_mises" || material.model == "tresca" || material.model == "softening_clay";
}

/// Whether the soil of a body is new in this run or stage.
bool begins(const BodyConfig& body) { return !body.absent && !body.removed && !body.from_before; }

/// Clay of which four particles or more in a cell keep their volume each: the cell has too few degrees of
/// freedom for them.
void warn_of_locking(const Config& config, const BodyConfig& body, Lines& lines) {
  constexpr double k_least = 0.5, k_compressible = 0.45;  // fraction of F-bar; Poisson's ratio
  const MaterialConfig& material = config.materials[body.material];
  const bool keeps_volume =
      parameter_of(material, "poisson") >= k_compressible || material.pore_stiffness > 0;
  const double fraction = f_bar_fraction(config, material);
  if (!is_clay(material) || !keeps_volume || fraction >= k_least || body.shape.particles_per_cell < 2) return;
  lines.push_back(formatted(
      "warning: -%sf_bar_fraction: given \"%g\", lets %s lock, since its particles keep their volume: a "
      "strip footing on 20 cells carries 10 %% too much; 0.98, the default, keeps it from locking",
      material.f_bar_fraction ? (material.name + "_").c_str() : "", fraction, material.name.c_str()));
}

/// Undrained clay whose volume changes under load.
void warn_of_volume(const MaterialConfig& material, Lines& lines) {
  constexpr double k_least = 0.4, k_strongest = 1e6;  // -, Pa: what is stronger is no clay
  const double poisson = parameter_of(material, "poisson");
  if (!is_clay(material) || material.pore_stiffness > 0 || !(poisson < k_least)) return;
  if (!(parameter_of(material, "su") <= k_strongest)) return;
  lines.push_back(
      formatted("warning: -%s_poisson: %g lets undrained clay change its volume: it sinks where it should "
                "heave; 0.45 to 0.495 keeps its volume",
                material.name.c_str(), poisson));
}

/// Coefficients of friction that are given as angles. Those of rigid bodies are at most 10.
void warn_of_coefficient(const std::string& option, double friction, Lines& lines) {
  constexpr double k_least = 11, k_most = 60;  // degrees
  if (friction < k_least || friction > k_most) return;
  lines.push_back(
      formatted("warning: -%s: %g looks like an angle in degrees; the coefficient is its tan, %.3g",
                option.c_str(), friction, std::tan(friction * std::numbers::pi / 180)));
}

void warn_of_coefficients(const Config& config, Lines& lines) {
  for (const ContactPairConfig& pair : config.contact_pairs)
    warn_of_coefficient(pair.name + "_friction", pair.friction.value_or(0), lines);
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side)
      if (config.mesh.walls[d][side] == Wall::friction)
        warn_of_coefficient(side_option(d, side) + "_friction", config.mesh.sides[d][side].numbers.friction,
                            lines);
}

/// A body of one particle a cell, between which cells are empty as soon as soil is stretched.
void warn_of_particles(const Config& config, const BodyConfig& body, Lines& lines) {
  const MaterialConfig& material = config.materials[body.material];
  const bool dilates = parameter_of(material, "dilation_deg") > 0;  // one is best there: docs/soils.md
  if (body.shape.particles_per_cell > 1 || dilates || config.particle_domain != ParticleDomain::fixed) return;
  lines.push_back(
      formatted("warning: -%s_particles_per_cell: with 1, cells are empty where soil is stretched by half, "
                "and it comes apart there; 2, the default, bears more, and -analysis flow any stretch",
                body.name.c_str()));
}

/// A body alone, of soil that sticks to no other, that is too thin for its cells, along an axis along which
/// it does not go through the whole mesh. Bodies of -contact_pairs have a warning of their own.
void warn_of_cells(const Config& config, const BodyConfig& body, Lines& lines) {
  constexpr double k_least = 3;  // cells
  const bool alone = std::none_of(config.bodies.begin(), config.bodies.end(), [&](const BodyConfig& other) {
    return &other != &body && touch(config, body, other);
  });
  if (body.shape.kind == ShapeKind::particles || !alone) return;
  const Bounds bounds = bounds_of(body.shape, config.mesh, config.dim);
  const double slack = 1e-6 * config.mesh.spacing;
  for (int d = 0; d < config.dim; ++d) {
    const bool through =
        bounds.lower[d] <= config.mesh.lower[d] + slack && bounds.upper[d] >= config.mesh.upper[d] - slack;
    const double cells = (bounds.upper[d] - bounds.lower[d]) / config.mesh.spacing;
    if (through || cells >= k_least * (1 - 1e-6)) continue;
    lines.push_back(
        formatted("warning: body %s is %.3g cells across along %c; soil of less than %g cells neither bends "
                  "nor shears as it should: take smaller cells (-mesh_spacing)",
                  body.name.c_str(), cells, "xyz"[d], k_least));
  }
}

/// Soil above a side that lets it fall out.
void warn_of_bottom(const Config& config, const BodyConfig& body, Lines& lines) {
  const int up = config.dim - 1;
  if (config.mesh.walls[up][0] != Wall::free || !(config.gravity[up] < 0)) return;
  const Bounds bounds = bounds_of(body.shape, config.mesh, config.dim);
  if (bounds.lower[up] > config.mesh.lower[up] + 1e-6 * config.mesh.spacing) return;
  lines.push_back(formatted(
      "warning: -%s: given \"free\", lets body %s fall out of the mesh under its weight; fixed (rough) or "
      "roller (smooth) carries it",
      side_option(up, 0).c_str(), body.name.c_str()));
}

/// Whether something pushes soil slowly: rigid bodies that move as prescribed, loads.
bool is_pushed(const Config& config) {
  return !config.loads.empty() ||
         std::any_of(config.rigids.begin(), config.rigids.end(), [](const auto& rigid) {
           return rigid.motion == Motion::prescribed && rigid.velocity != Vec3{};
         });
}

/// Heavy soil without stress, that is pushed while it still settles.
void warn_of_settlement(const Config& config, const BodyConfig& body, Lines& lines) {
  constexpr double k_least = 1e-3, k_most = 0.1;  // of the height; more comes of a modulus in kPa
  const Vec3& g = config.gravity;
  if (!config.stages.empty() || !config.output.restart.empty() || config.damping > 0 || !is_pushed(config))
    return;
  if (body.stress_given || body.k0 || body.shape.kind == ShapeKind::particles) return;
  const auto heights = heights_of(body.shape, config);
  const double height = heights[1] - heights[0], wave = wave_speed(config, body);
  const double strain = std::hypot(g[0], g[1], g[2]) * height / (2 * wave * wave);
  if (!(strain > k_least && strain < k_most)) return;
  lines.push_back(formatted(
      "warning: body %s begins without stress, so that its weight presses it down by %.3g m, and it swings, "
      "while it is loaded; -%s_stress k0 begins as level ground, and a first stage with -damping brings a "
      "slope to rest",
      body.name.c_str(), strain * height, body.name.c_str()));
}

/// Length of a step [s], as the run begins.
double step_of(const Config& config) {
  return config.time.step.value_or(
      std::min(config.time.courant * critical_time_step(config), viscous_time_step(config)));
}

/// Frames that are too many: of nearly every step, or thousands.
void warn_of_frames(const Config& config, double step, Lines& lines) {
  constexpr double k_steps = 10, k_most = 3000;
  const double interval = config.output.interval, count = (config.time.end - config.time.start) / interval;
  if (!config.output.frames || !(interval > 0) || count < 100) return;
  if (interval >= k_steps * step && count <= k_most) return;
  lines.push_back(formatted(
      "warning: -output_interval: %g s make %.0f frames of all particles, one every %.3g steps; a hundred "
      "show a run, -history_interval and -probes follow what is fast",
      interval, count, interval / step));
}

/// Motions so slow that a step moves a particle by less than its coordinate resolves.
void warn_of_single(const Config& config, double step, Lines& lines) {
  constexpr double k_least = 100 * 6e-8;  // cells a step, where a coordinate in a cell is rounded by 6e-8
  if (config.precision != Precision::single) return;
  for (const RigidConfig& rigid : config.rigids) {
    const Vec3& v = rigid.velocity;
    const double moved = std::hypot(v[0], v[1], v[2]) * step / config.mesh.spacing;
    if (rigid.motion != Motion::prescribed || moved == 0 || moved >= k_least) continue;
    lines.push_back(formatted(
        "warning: -precision: given \"single\", but rigid %s moves by %.2g of a cell a step, and single "
        "precision rounds places of soil by 6e-08 of a cell: -precision double, or a faster motion",
        rigid.name.c_str(), moved));
  }
}

/// A run that ends before a wave has crossed the soil: nothing of it has come to rest, or to flow.
void warn_of_end(const Config& config, Lines& lines) {
  const double time = config.time.end - config.time.start;
  if (!config.stages.empty() || config.time.max_steps || !is_pushed(config)) return;
  double crossing = 0;
  for (const BodyConfig& body : config.bodies) {
    if (!begins(body) || body.shape.kind == ShapeKind::particles) continue;
    const Bounds bounds = bounds_of(body.shape, config.mesh, config.dim);
    double way = std::numeric_limits<double>::infinity();
    for (int d = 0; d < config.dim; ++d) way = std::min(way, bounds.upper[d] - bounds.lower[d]);
    crossing = std::max(crossing, way / wave_speed(config, body));
  }
  if (time < crossing)
    lines.push_back(formatted(
        "warning: -time_end: %g s are over before a pressure wave has gone through the soil once, in "
        "%.3g s: what is slow needs many times that",
        config.time.end, crossing));
}

}  // namespace

std::vector<std::string> warnings_of_choices(const Config& config) {
  Lines lines;
  std::vector<char> seen(config.materials.size());
  for (const BodyConfig& body : config.bodies) {
    const MaterialConfig& material = config.materials[body.material];
    if (!std::exchange(seen[body.material], 1)) {
      warn_of_locking(config, body, lines);
      warn_of_volume(material, lines);
    }
    if (!begins(body)) continue;
    warn_of_particles(config, body, lines);
    warn_of_cells(config, body, lines);
    warn_of_bottom(config, body, lines);
    warn_of_settlement(config, body, lines);
  }
  warn_of_coefficients(config, lines);
  if (config.bodies.empty()) return lines;
  const double step = step_of(config);
  warn_of_frames(config, step, lines);
  warn_of_single(config, step, lines);
  warn_of_end(config, lines);
  return lines;
}

}  // namespace mpm
