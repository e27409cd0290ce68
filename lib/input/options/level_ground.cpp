#include "input/options/level_ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/presence.hpp"
#include "common/text.hpp"
#include "input/geometry/height_surface.hpp"
#include "input/geometry/polygon.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr double k_degree = 0.017453292519943295;

double friction_of(const MaterialConfig& material) {
  const double degrees = parameter_of(material, "friction_deg");
  return std::isnan(degrees) ? std::atan(parameter_of(material, "mu_static")) : degrees * k_degree;
}

/// Parts of a vertical line that are in a shape [m].
using Spans = std::vector<std::array<double, 2>>;

/// Whether spans_of can treat a shape.
bool has_spans(const Shape& shape) {
  if (shape.kind == ShapeKind::box) return shape.angle == 0 && shape.fillet == 0;
  return shape.kind == ShapeKind::layer || shape.kind == ShapeKind::polygon;
}

Spans spans_of_polygon(const Polygon& polygon, double x) {
  std::vector<double> heights;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const auto [from, to] = edge_of(polygon, k);
    if ((from[0] <= x) == (to[0] <= x)) continue;
    heights.push_back(from[1] + (to[1] - from[1]) * ((x - from[0]) / (to[0] - from[0])));
  }
  std::sort(heights.begin(), heights.end());
  Spans spans;
  for (std::size_t k = 1; k < heights.size(); k += 2) spans.push_back({heights[k - 1], heights[k]});
  return spans;
}

Spans spans_of(const Shape& shape, const MeshConfig& mesh, int dim, const Vec3& place) {
  const int up = dim - 1;
  if (shape.kind == ShapeKind::polygon) {
    const bool beside = dim == 3 && (place[1] < shape.width[0] || place[1] > shape.width[1]);
    return beside ? Spans{} : spans_of_polygon(shape.polygon, place[0]);
  }
  if (shape.kind == ShapeKind::box) {
    for (int d = 0; d < up; ++d)
      if (place[d] < shape.lower[d] || place[d] > shape.upper[d]) return {};
    return {{shape.lower[up], shape.upper[up]}};
  }
  const double top = shape.top->at(place[0], place[1]),
               base = shape.base ? shape.base->at(place[0], place[1]) : mesh.lower[up];
  return top > base ? Spans{{base, top}} : Spans{};
}

bool hold(const Spans& spans, double height) {
  return std::any_of(spans.begin(), spans.end(),
                     [=](const auto& span) { return height > span[0] && height < span[1]; });
}

/// Reason why a body cannot have the stress of level ground, as the end of "takes ..."; empty where it can.
std::string fault_of(const Config& config, const BodyConfig& body) {
  const int up = config.dim - 1;
  bool down = config.gravity[up] < 0;
  for (int d = 0; d < up; ++d) down = down && config.gravity[d] == 0;
  const std::string numbers = "numbers, or k0 ";
  if (!down || config.gravity_table) return numbers + "where a constant -gravity points down the last axis";
  if (!has_spans(body.shape))
    return numbers + "of a box that is neither turned nor has a fillet, of a polygon or of a layer";
  if (std::isnan(k0_of(config.materials[body.material])))
    return numbers + "where -" + config.materials[body.material].name + "_k0 is given";
  return "";
}

/// Places over the ground that a check tests: the middles of cells of half the mesh's, or larger ones.
std::vector<Vec3> places_over(const Bounds& bounds, double spacing, int dim) {
  constexpr double k_most[] = {4000, 250};  // along an axis, in 2D and in 3D
  std::array<long, 2> count{1, 1};
  for (int d = 0; d < dim - 1; ++d) {
    const double cells = std::ceil((bounds.upper[d] - bounds.lower[d]) / (spacing / 2) - 1e-6);
    count[d] = std::lround(std::clamp(cells, 1.0, k_most[dim - 2]));
  }
  std::vector<Vec3> places;
  for (long j = 0; j < count[1]; ++j)
    for (long i = 0; i < count[0]; ++i) {
      Vec3& place = places.emplace_back();
      const std::array<long, 2> at{i, j};
      for (int d = 0; d < dim - 1; ++d)
        place[d] = bounds.lower[d] + (bounds.upper[d] - bounds.lower[d]) *
                                         ((static_cast<double>(at[d]) + 0.5) / static_cast<double>(count[d]));
    }
  return places;
}

/// Bounds of all bodies with k0 that are in the run, as seen from above; of the new ones alone in a later
/// stage.
std::optional<Bounds> bounds_of_ground(const Config& config) {
  std::optional<Bounds> all;
  for (const BodyConfig& body : config.bodies) {
    if (!body.k0 || body.absent || body.removed || body.from_before) continue;
    const Bounds bounds = within(bounds_of(body.shape, config.mesh, config.dim), config.mesh, config.dim);
    if (!all) all = bounds;
    for (int d = 0; d < config.dim; ++d) {
      all->lower[d] = std::min(all->lower[d], bounds.lower[d]);
      all->upper[d] = std::max(all->upper[d], bounds.upper[d]);
    }
  }
  return all;
}

/// Checks that the bodies are one upon the other, and that their top is level.
void check_columns(OptionReader& in, const Config& config, const LevelGround& ground,
                   const std::vector<Vec3>& places) {
  const double slack = 1e-6 * config.mesh.spacing;
  const auto is_new = [&](const LevelGround::Layer& layer) { return !config.bodies[layer.body].from_before; };
  const auto counts = [&](const std::vector<LevelGround::Layer>& column) {
    return config.stage.number <= 1 || std::any_of(column.begin(), column.end(), is_new);
  };
  double top = -std::numeric_limits<double>::infinity();
  for (const Vec3& place : places)
    if (const auto& column = ground.column(place); !column.empty() && counts(column))
      top = std::max(top, column[0].top);
  std::string name;
  for (const BodyConfig& body : config.bodies)
    if (name.empty() && body.k0 && !body.from_before && !body.absent && !body.removed) name = body.name;
  for (const Vec3& place : places) {
    const auto& column = ground.column(place);
    if (!counts(column)) continue;
    for (std::size_t k = 1; k < column.size(); ++k) {
      const double gap = column[k - 1].base - column[k].top;
      if (gap <= slack || !(is_new(column[k - 1]) || is_new(column[k]))) continue;
      const std::string upper = config.bodies[column[k - 1].body].name,
                        lower = config.bodies[column[k].body].name;
      return in.reject(lower + "_stress",
                       formatted("numbers, or k0 of layers one upon the other; %s is below %s by "
                                 "%.6g m",
                                 lower.c_str(), upper.c_str(), gap));
    }
    if (!column.empty() && top - column[0].top <= slack) continue;
    const std::string at = config.dim == 2 ? "x = " + text_of({&place[0], 1}) : text_of({&place[0], 2});
    const std::string low = column.empty() ? "none" : formatted("at %.6g m", column[0].top);
    return in.reject(
        (column.empty() ? name : config.bodies[column[0].body].name) + "_stress",
        formatted("numbers, or k0 of bodies that together are level ground; their top is at %.6g m, "
                  "at %s %s",
                  top, at.c_str(), low.c_str()));
  }
}

/// A ratio at which sand without cohesion would yield at once.
void check_ratio(OptionReader& in, const MaterialConfig& material) {
  const double friction = friction_of(material), cohesion = parameter_of(material, "cohesion");
  if (std::isnan(friction) || cohesion > 0) return;
  const double sine = std::sin(friction), active = (1 - sine) / (1 + sine), k0 = k0_of(material);
  if (k0 < active || k0 > 1 / active)
    in.reject(material.name + "_k0",
              formatted("a number from %.4g to %.4g, between which soil with this friction does not yield",
                        active, 1 / active));
}

}  // namespace

double k0_of(const MaterialConfig& material) {
  if (material.k0) return *material.k0;
  if (material.model == "cam_clay") return std::numeric_limits<double>::quiet_NaN();
  if (material.model == "newtonian" || material.model == "yield_stress_fluid") return 1;
  if (const double friction = friction_of(material); friction > 0) return 1 - std::sin(friction);
  const double poisson = parameter_of(material, "poisson");
  return poisson / (1 - poisson);
}

const std::vector<LevelGround::Layer>& LevelGround::column(const Vec3& place) const {
  const auto [found, is_new] = columns_.try_emplace({place[0], config_.dim == 3 ? place[1] : 0.0});
  std::vector<Layer>& layers = found->second;
  if (!is_new) return layers;
  std::vector<Spans> spans(config_.bodies.size());
  std::vector<double> levels;
  const auto is_there = [](const BodyConfig& body) { return body.k0 && !body.absent && !body.removed; };
  for (std::size_t b = 0; b < spans.size(); ++b) {
    if (!config_.bodies[b].k0) continue;
    spans[b] = spans_of(config_.bodies[b].shape, config_.mesh, config_.dim, place);
    for (const auto& [base, top] : spans[b]) levels.push_back(base), levels.push_back(top);
  }
  std::sort(levels.begin(), levels.end());
  for (std::size_t k = levels.size(); k-- > 1;) {
    const double middle = (levels[k - 1] + levels[k]) / 2;
    for (std::size_t b = 0; b < spans.size(); ++b) {
      const BodyConfig& body = config_.bodies[b];
      const auto cuts = [&](int other) {
        const BodyConfig& cutter = config_.bodies[other];
        return placed_at(config_.stage, cutter.name) == placed_at(config_.stage, body.name) &&
               hold(spans[other], middle);
      };
      if (!is_there(body) || !hold(spans[b], middle) ||
          std::any_of(body.cut_out_bodies.begin(), body.cut_out_bodies.end(), cuts))
        continue;
      if (!layers.empty() && layers.back().body == static_cast<int>(b) && layers.back().base == levels[k])
        layers.back().base = levels[k - 1];
      else
        layers.push_back({static_cast<int>(b), levels[k - 1], levels[k], density_of(config_, body)});
      break;
    }
  }
  return layers;
}

double LevelGround::vertical(const Vec3& place) const {
  const double gravity = std::fabs(config_.gravity[config_.dim - 1]), height = place[config_.dim - 1];
  const double level = config_.water.level.value_or(-std::numeric_limits<double>::infinity());
  double stress = 0;
  for (const Layer& layer : column(place)) {
    const double from = std::max(height, layer.base);
    stress += gravity * (layer.density * std::max(0.0, layer.top - from) -
                         config_.water.density * std::max(0.0, std::min(layer.top, level) - from));
  }
  return stress;
}

Sym6 LevelGround::stress(const BodyConfig& body, const Vec3& centre, double width) const {
  const int up = config_.dim - 1;
  Vec3 low = centre, high = centre;
  low[up] -= width / 2, high[up] += width / 2;
  const double down = (vertical(low) + vertical(high)) / 2,
               across = k0_of(config_.materials[body.material]) * down;
  Sym6 stress{-across, -across, -across, 0, 0, 0};
  stress[up] = -down;
  return stress;
}

void check_level_ground(OptionReader& in, const MeshConfig& mesh, Config& config) {
  const auto errors = in.errors();
  for (const BodyConfig& body : config.bodies)
    if (const std::string fault = body.k0 && !body.from_before ? fault_of(config, body) : ""; !fault.empty())
      in.reject(body.name + "_stress", fault);
  const auto bounds = bounds_of_ground(config);
  if (in.errors() != errors || !bounds) return;
  const LevelGround ground(config);
  const std::vector<Vec3> places = places_over(*bounds, mesh.spacing, config.dim);
  check_columns(in, config, ground, places);
  for (const BodyConfig& body : config.bodies)
    if (body.k0 && !body.from_before && !body.absent && !body.removed)
      check_ratio(in, config.materials[body.material]);
  if (in.errors() != errors) return;
  // The least and the largest stress of each body.
  struct Ends {
    bool any = false;
    Sym6 least{}, most{};
    double high = 0, low = 0;  // m, where they are
  };
  std::vector<Ends> ends(config.bodies.size());
  const int up = config.dim - 1;
  for (Vec3 place : places)
    for (const LevelGround::Layer& layer : ground.column(place)) {
      const BodyConfig& body = config.bodies[layer.body];
      Ends& own = ends[layer.body];
      const double width = std::min(mesh.spacing / body.shape.particles_per_cell, layer.top - layer.base);
      for (const bool top : {true, false}) {
        place[up] = top ? layer.top - width / 2 : layer.base + width / 2;
        const Sym6 stress = ground.stress(body, place, width);
        if (!own.any || stress[up] > own.least[up]) own.least = stress, own.high = place[up];
        if (!own.any || stress[up] < own.most[up]) own.most = stress, own.low = place[up];
        own.any = true;
      }
    }
  for (std::size_t b = 0; b < ends.size(); ++b) {
    BodyConfig& body = config.bodies[b];
    if (!ends[b].any || body.from_before) continue;  // the stress of the latter is that of the soil
    const MaterialConfig& material = config.materials[body.material];
    const Sym6& low = ends[b].most;
    if (check_start(in, body.name, material, ends[b].low, low, config.dim))
      check_start(in, body.name, material, ends[b].high, ends[b].least, config.dim);
    body.stress = low;
    body.largest_pressure = std::max(0.0, -(low[0] + low[1] + low[2]) / 3);
  }
}

}  // namespace mpm
