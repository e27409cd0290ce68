#include "check/warnings_soil.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/text.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {

bool touch(const Config& config, const BodyConfig& a, const BodyConfig& b) {
  if (a.shape.kind == ShapeKind::particles || b.shape.kind == ShapeKind::particles) return true;
  const Bounds one = bounds_of(a.shape, config.mesh, config.dim),
               other = bounds_of(b.shape, config.mesh, config.dim);
  for (int d = 0; d < config.dim; ++d)
    if (std::max(one.lower[d], other.lower[d]) - std::min(one.upper[d], other.upper[d]) >=
        config.mesh.spacing)
      return false;
  return true;
}

namespace {

/// Level [m] of the water half a cell below the middle of a body.
double water_level_under(const Config& config, const BodyConfig& body) {
  const Bounds bounds = bounds_of(body.shape, config.mesh, config.dim);
  const int up = config.dim - 1;
  Vec3 place{};
  for (int d = 0; d < config.dim; ++d) place[d] = (bounds.lower[d] + bounds.upper[d]) / 2;
  place[up] = bounds.lower[up] - config.mesh.spacing / 2;
  double level = *config.water.level;
  for (const WaterRegionConfig& region : config.water.regions) {
    bool inside = region.dry || region.level;
    for (int d = 0; d < config.dim; ++d)
      inside = inside && place[d] >= region.lower[d] && place[d] <= region.upper[d];
    if (inside) level = region.dry ? -std::numeric_limits<double>::infinity() : *region.level;
  }
  return level;
}

/// Whether soil may move far, so that bodies that are apart meet.
bool moves(const Config& config) {
  const auto is_moved = [](const auto& each) { return each.velocity != Vec3{}; };
  return config.gravity != Vec3{} || !config.loads.empty() ||
         std::any_of(config.bodies.begin(), config.bodies.end(), is_moved) ||
         std::any_of(config.rigids.begin(), config.rigids.end(),
                     [](const RigidConfig& rigid) { return rigid.motion != Motion::fixed; });
}

}  // namespace

std::vector<std::string> warnings_of_pores(const Config& config) {
  constexpr double k_soft = 20, k_stiff = 400, k_darcy = 0.1, k_loose = 0.8;
  std::vector<std::string> lines;
  for (const MaterialConfig& material : config.materials) {
    if (!material.saturated()) continue;
    const PoreConfig& pores = material.pores;
    const double young = parameter_of(material, "young"), poisson = parameter_of(material, "poisson"),
                 modulus = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)),
                 ratio = config.water.bulk_modulus / pores.porosity / modulus;
    if (ratio < k_soft)
      lines.push_back(
          formatted("warning: -water_bulk_modulus: over the porosity it is %.3g times the wave modulus "
                    "of %s; below %g its consolidation is slower by 5 %% and more",
                    ratio, material.name.c_str(), k_soft));
    if (ratio > k_stiff)
      lines.push_back(
          formatted("warning: -water_bulk_modulus: over the porosity it is %.3g times the wave modulus "
                    "of %s; 50 times costs 2 %% in the rate of consolidation, and the step is %.2g "
                    "times as long",
                    ratio, material.name.c_str(), std::sqrt(ratio / 50)));
    if (pores.permeability * config.water.permeability_scale > k_darcy)
      lines.push_back(
          formatted("warning: -%s_permeability: %.3g m/s with -permeability_scale; above %g m/s flow "
                    "does not follow Darcy's law",
                    material.name.c_str(), pores.permeability * config.water.permeability_scale, k_darcy));
    if (pores.porosity > k_loose)
      lines.push_back(
          formatted("warning: -%s_porosity: %g; above %g grains and water part, which one set of "
                    "particles cannot do",
                    material.name.c_str(), pores.porosity, k_loose));
  }
  return lines;
}

std::vector<std::string> warnings_of_excavations(const Config& config) {
  std::vector<std::string> lines;
  if (!config.water.level) return lines;
  for (const int b : config.stage.remove) {
    const BodyConfig& body = config.bodies[b];
    if (body.shape.kind == ShapeKind::particles) continue;
    const double depth = water_level_under(config, body) - heights_of(body.shape, config)[0];
    if (depth > 0)
      lines.push_back(formatted(
          "warning: -%s_remove: the excavation of %s reaches %.4g m below the water and is full of it; "
          "-water_regions with a level of their own keep it dry",
          config.stage.name.c_str(), body.name.c_str(), depth));
  }
  return lines;
}

namespace {

/// Whether -contact_pairs has two bodies that may slide on each other.
bool is_pair(const Config& config, const BodyConfig& one, const BodyConfig& other) {
  return std::any_of(
      config.contact_pairs.begin(), config.contact_pairs.end(), [&](const ContactPairConfig& pair) {
        const BodyConfig *a = &config.bodies[pair.bodies[0]], *b = &config.bodies[pair.bodies[1]];
        return !pair.welded && ((a == &one && b == &other) || (a == &other && b == &one));
      });
}

/// A line for each upper face of a box beside which its particles end: their lattice begins at the lower
/// corner, and holds those whose centre is in the box.
void add_gaps(const Config& config, const BodyConfig& body, std::vector<std::string>& lines) {
  constexpr double k_least = 0.05;  // cells
  if (body.shape.kind != ShapeKind::box || body.shape.fill != Fill::centre) return;
  const double spacing = config.mesh.spacing, edge = spacing / body.shape.particles_per_cell;
  for (int d = 0; d < config.dim; ++d) {
    if (body.shape.upper[d] >= config.mesh.upper[d]) continue;  // no other body is there
    const double length = body.shape.upper[d] - std::max(body.shape.lower[d], config.mesh.lower[d]);
    const double beyond = std::round(length / edge) * edge - length;
    if (std::abs(beyond) < k_least * spacing) continue;
    lines.push_back(
        formatted("warning: body %s of -contact_pairs: along %c its particles end %.3g m %s its face, %.2g "
                  "cells, so that others meet it %s; an edge of whole particles, of %g m, has its face where "
                  "it is given",
                  body.name.c_str(), "xyz"[d], std::abs(beyond), beyond < 0 ? "short of" : "beyond",
                  std::abs(beyond) / spacing, beyond < 0 ? "late" : "early", edge));
  }
}

}  // namespace

std::vector<std::string> warnings_of_pairs(const Config& config) {
  constexpr double k_least = 2;  // cells; both faces of a thinner body reach the same nodes
  std::vector<std::string> lines;
  for (std::size_t b = 0; b < config.bodies.size(); ++b) {
    const BodyConfig& body = config.bodies[b];
    const auto slides = [&](const ContactPairConfig& pair) {
      return !pair.welded && std::count(pair.bodies.begin(), pair.bodies.end(), static_cast<int>(b)) > 0;
    };
    if (body.shape.kind == ShapeKind::particles ||
        std::none_of(config.contact_pairs.begin(), config.contact_pairs.end(), slides))
      continue;
    const double cells = narrowest(body.shape, config.mesh, config.dim) / config.mesh.spacing;
    if (cells < k_least * (1 - 1e-6))
      lines.push_back(
          formatted("warning: body %s of -contact_pairs is %.3g cells across; below %g cells its two faces "
                    "share nodes, "
                    "and contact takes the wrong normals: take smaller cells",
                    body.name.c_str(), cells, k_least));
    add_gaps(config, body, lines);
  }
  return lines;
}

std::string note_of_touching(const Config& config) {
  constexpr std::size_t k_most = 8;
  std::vector<std::string> names;
  const bool all = moves(config);
  for (const BodyConfig& body : config.bodies) {
    const bool meets = std::any_of(config.bodies.begin(), config.bodies.end(), [&](const BodyConfig& other) {
      return &other != &body && !is_pair(config, body, other) && (all || touch(config, body, other));
    });
    if (meets) names.push_back(body.name);
  }
  if (names.empty()) return "";
  if (names.size() > k_most) names.resize(k_most), names.emplace_back("...");
  return "the bodies " + join(names, ", ") +
         " stick to each other where they touch or meet: no slip, no gap; -contact_pairs lets them slide and "
         "part";
}

}  // namespace mpm
