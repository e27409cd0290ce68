#include "input/level_ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/text.hpp"
#include "input/groups.hpp"
#include "input/height_surface.hpp"
#include "input/shapes.hpp"

namespace mpm {
namespace {

constexpr double k_degree = 0.017453292519943295;

double friction_of(const MaterialConfig& material) {
  const double degrees = parameter_of(material, "friction_deg");
  return std::isnan(degrees) ? std::atan(parameter_of(material, "mu_static")) : degrees * k_degree;
}

/// Whether a shape is between two levels.
bool is_level(const Shape& shape) {
  if (shape.kind == ShapeKind::box) return shape.angle == 0 && shape.fillet == 0;
  return shape.kind == ShapeKind::layer && shape.top->is_level() && (!shape.base || shape.base->is_level());
}

/// What keeps a body from the stress of level ground, as the end of "takes ..."; empty where nothing does.
std::string fault_of(const Config& config, const BodyConfig& body) {
  const int up = config.dim - 1;
  bool down = config.gravity[up] < 0;
  for (int d = 0; d < up; ++d) down = down && config.gravity[d] == 0;
  const std::string numbers = "numbers, or k0 ";
  if (!down || config.gravity_table) return numbers + "where a constant -gravity points down the last axis";
  if (!is_level(body.shape))
    return numbers + "of a box that is neither turned nor has a fillet, or of a layer between levels";
  if (std::isnan(k0_of(config.materials[body.material])))
    return numbers + "where -" + config.materials[body.material].name + "_k0 is given";
  return "";
}

/// Whether layers lie one upon the other.
void check_layers(OptionReader& in, const Config& config, const LevelGround& ground, double slack) {
  const auto& layers = ground.layers();
  for (std::size_t k = 1; k < layers.size(); ++k) {
    const double gap = layers[k - 1].base - layers[k].top;
    const bool as_before =
        config.bodies[layers[k - 1].body].from_before && config.bodies[layers[k].body].from_before;
    if (std::fabs(gap) <= slack || as_before) continue;
    const std::string upper = config.bodies[layers[k - 1].body].name,
                      lower = config.bodies[layers[k].body].name;
    return in.reject(
        lower + "_stress",
        formatted("numbers, or k0 of layers one upon the other; %s %s %s by %.6g m", lower.c_str(),
                  gap > 0 ? "is below" : "goes into", upper.c_str(), std::fabs(gap)));
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

LevelGround::LevelGround(const Config& config) : config_(config) {
  for (int b = 0; b < static_cast<int>(config.bodies.size()); ++b) {
    const BodyConfig& body = config.bodies[b];
    if (!body.k0 || body.absent || body.removed) continue;
    const Bounds bounds = bounds_of(body.shape, config.mesh, config.dim);
    layers_.push_back(
        {b, bounds.lower[config.dim - 1], bounds.upper[config.dim - 1], density_of(config, body)});
  }
  std::sort(layers_.begin(), layers_.end(), [](const Layer& a, const Layer& b) { return a.top > b.top; });
}

double LevelGround::vertical(double height) const {
  const double gravity = std::fabs(config_.gravity[config_.dim - 1]);
  const double level = config_.water.level.value_or(-std::numeric_limits<double>::infinity());
  double stress = 0;
  for (const Layer& layer : layers_) {
    const double from = std::max(height, layer.base);
    stress += gravity * (layer.density * std::max(0.0, layer.top - from) -
                         config_.water.density * std::max(0.0, std::min(layer.top, level) - from));
  }
  return stress;
}

Sym6 LevelGround::stress(const BodyConfig& body, double height, double width) const {
  const double down = (vertical(height - width / 2) + vertical(height + width / 2)) / 2,
               across = k0_of(config_.materials[body.material]) * down;
  Sym6 stress{-across, -across, -across, 0, 0, 0};
  stress[config_.dim - 1] = -down;
  return stress;
}

void check_level_ground(OptionReader& in, const MeshConfig& mesh, Config& config) {
  const auto errors = in.errors();
  for (const BodyConfig& body : config.bodies)
    if (const std::string fault = body.k0 && !body.from_before ? fault_of(config, body) : ""; !fault.empty())
      in.reject(body.name + "_stress", fault);
  if (in.errors() != errors) return;
  const LevelGround ground(config);
  check_layers(in, config, ground, 1e-6 * mesh.spacing);
  for (const LevelGround::Layer& layer : ground.layers())
    if (const BodyConfig& body = config.bodies[layer.body]; !body.from_before)
      check_ratio(in, config.materials[body.material]);
  if (in.errors() != errors) return;
  for (const LevelGround::Layer& layer : ground.layers()) {
    BodyConfig& body = config.bodies[layer.body];
    if (body.from_before) continue;  // its stress is that of the soil
    const MaterialConfig& material = config.materials[body.material];
    const double width = mesh.spacing / body.shape.particles_per_cell;
    const Sym6 low = ground.stress(body, layer.base + width / 2, width),
               high = ground.stress(body, layer.top - width / 2, width);
    if (check_start(in, body.name, material, layer.base + width / 2, low))
      check_start(in, body.name, material, layer.top - width / 2, high);
    body.stress = low;
    body.largest_pressure = std::max(0.0, -(low[0] + low[1] + low[2]) / 3);
  }
}

}  // namespace mpm
