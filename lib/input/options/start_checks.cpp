// Whether the laws of the soil can start from the initial stress.

#include <algorithm>

#include "common/material_table.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {
namespace {

double pressure_of(const Sym6& stress) { return -(stress[0] + stress[1] + stress[2]) / 3; }  // Pa

/// The stress of particle p of a file; that of the body where the file has none or options give it.
Sym6 stress_of(const BodyConfig& body, const ParticleTable& listed, std::size_t p, int dim) {
  if (listed.stress.empty()) return body.stress;
  const std::size_t components = dim == 2 ? 4 : 6;
  Sym6 stress{};
  for (std::size_t k = 0; k < components; ++k) stress[k] = listed.stress[p * components + k];
  return stress;
}

}  // namespace

void check_starts(OptionReader& in, const MeshConfig& mesh, const Config& config, const ParticleTable& listed,
                  BodyConfig& body) {
  if (body.material < 0 || body.material >= static_cast<int>(config.materials.size())) return;  // reported
  const MaterialConfig& material = config.materials[body.material];
  const int up = config.dim - 1;
  body.largest_pressure = std::max(0.0, pressure_of(body.stress));
  if (body.from_before) return;  // it goes on as it is
  if (body.shape.kind != ShapeKind::particles) {
    const Bounds bounds = bounds_of(body.shape, mesh, config.dim);
    if (check_start(in, body.name, material, bounds.lower[up], body.stress, config.dim))
      check_start(in, body.name, material, bounds.upper[up], body.stress, config.dim);
    return;
  }
  const auto keys = own_parameters(state_variables(material));
  std::array<const std::vector<double>*, k_most_own> own{};
  for (std::size_t k = 0; k < keys.size(); ++k)
    for (const StateField& field : listed.own_parameters)
      if (field.name == keys[k]) own[k] = &field.values;
  bool looks = !listed.own_parameters.empty() ||
               std::all_of(listed.state.begin(), listed.state.end(),
                           [](const StateField& field) { return field.name == k_excess_pore_pressure; });
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (own[k] != nullptr) body.largest_own[k] = *std::max_element(own[k]->begin(), own[k]->end());
  for (std::size_t p = 0; p < listed.volume.size(); ++p) {
    const bool is_new = listed.reference_height.empty();
    const double height = is_new ? listed.position[p * config.dim + up] : listed.reference_height[p];
    const Sym6 stress = stress_of(body, listed, p, config.dim);
    body.largest_pressure = std::max(body.largest_pressure, pressure_of(stress));
    OwnValues of_particle{};
    for (std::size_t k = 0; k < keys.size(); ++k)
      if (own[k] != nullptr) of_particle[k] = (*own[k])[p];
    looks = looks && check_start(in, body.name, material, height, stress, config.dim, of_particle);
  }
}

void prepare_for_pressure(double spacing, Config& config) {
  std::vector<double> largest(config.materials.size());
  for (const BodyConfig& body : config.bodies)
    if (body.material >= 0 && body.material < static_cast<int>(largest.size()))
      largest[body.material] = std::max(largest[body.material], body.largest_pressure);
  for (std::size_t m = 0; m < largest.size(); ++m) prepare_material(config.materials[m], spacing, largest[m]);
}

}  // namespace mpm
