// Speeds of waves in the materials of a configuration, which limit its time step.

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/material_table.hpp"
#include "input/geometry/shapes.hpp"
#include "physics/materials/any.hpp"
#include "physics/pore_flow.hpp"
#include "step/stepper.hpp"

namespace mpm {

double wave_speed(const Config& config, const BodyConfig& body) {
  const MaterialConfig& material = config.materials[body.material];
  const double lowest = bounds_of(body.shape, config.mesh, config.dim).lower[config.dim - 1];
  const auto law =
      make_material<double>(model_index(material.model), material.parameters, material.object.get());
  Sym6 stress = body.stress;
  const bool of_file = body.shape.kind == ShapeKind::particles && !body.stress_given;
  if (of_file) stress = {-body.largest_pressure, -body.largest_pressure, -body.largest_pressure};
  const double modulus = wave_modulus(law, lowest, stress, body.largest_own);
  if (material.saturated())
    return std::sqrt(fast_wave_square(modulus, material.pores.porosity, material.pores.grain_density,
                                      config.water.density, config.water.bulk_modulus));
  return std::sqrt((modulus + material.pore_stiffness) / density_of(config, body));
}

bool stiffness_changes(const Config& config) {
  return std::any_of(config.bodies.begin(), config.bodies.end(), [&](const BodyConfig& body) {
    const MaterialConfig& material = config.materials[body.material];
    return !body.absent && (material.saturated() || stiffness_changes(model_index(material.model)));
  });
}

double critical_time_step(const Config& config) {
  double step = std::numeric_limits<double>::infinity();
  for (const BodyConfig& body : config.bodies)
    if (!body.absent) step = std::min(step, config.mesh.spacing / wave_speed(config, body));
  return step;
}

double viscous_time_step(const Config& config) {
  double step = std::numeric_limits<double>::infinity();
  for (const BodyConfig& body : config.bodies) {
    if (body.absent) continue;
    const MaterialConfig& material = config.materials[body.material];
    const auto law =
        make_material<double>(model_index(material.model), material.parameters, material.object.get());
    step = std::min(step, largest_time_step(law, config.mesh.spacing, density_of(config, body), config.dim));
  }
  return step;
}

}  // namespace mpm
