// A body whose particles take a strength and a Young's modulus from a field.

#include <algorithm>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "input/files/field_file.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

bool is_one_of(const std::vector<std::string>& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

/// Why a body's material takes nothing from a field; empty where it does.
std::string takes_no_field(const MaterialConfig& material) {
  if (own_parameters(state_variables(material.model)).empty())
    return "nothing here: the model " + material.model + " has no strength and no stiffness of each particle";
  if (own_parameters(state_variables(material)).empty())
    return "nothing here: -" + material.name + "_young is a number; field takes it from a file";
  return "";
}

/// Whether particles with any values of the grids may start: the strongest with the softest, or else those at
/// each point.
void check_field_starts(OptionReader& in, const BodyConfig& body, const MaterialConfig& material,
                        const Bounds& bounds, int dim, const std::vector<NamedGrid>& grids) {
  const auto keys = own_parameters(state_variables(material));
  const auto place = [&](const NamedGrid& named) {
    return static_cast<std::size_t>(std::find(keys.begin(), keys.end(), named.key) - keys.begin());
  };
  OwnValues worst{};
  for (const NamedGrid& named : grids) {
    const auto [least, largest] = std::minmax_element(named.grid.values.begin(), named.grid.values.end());
    worst[place(named)] = named.key == "young" ? *least : *largest;
  }
  const double foot = bounds.lower[dim - 1], top = bounds.upper[dim - 1];
  if (may_start(material, foot, body.stress, dim, worst) && may_start(material, top, body.stress, dim, worst))
    return;
  if (grids.size() == 1) {
    if (check_start(in, body.name, material, foot, body.stress, dim, worst))
      check_start(in, body.name, material, top, body.stress, dim, worst);
    return;
  }
  for (const NamedGrid& points : grids)
    for (std::size_t n = 0; n < points.grid.values.size(); ++n) {
      OwnValues own{};
      for (const NamedGrid& named : grids) own[place(named)] = named.grid.at(points.grid.place_of(n));
      if (!check_start(in, body.name, material, foot, body.stress, dim, own)) return;
    }
}

}  // namespace

void read_body_field(OptionReader& in, const std::string& name, bool listed, BodyConfig& body) {
  if (listed && !in.listing())
    return in.not_taken(name + "_field", "the particles are those of " + name + "_file");
  in.text(
      {.name = name + "_field",
       .meaning = "HDF5 file with grids of parameters of the material's law by their keys, of the strength "
                  "(su or cohesion), of Young's modulus (young), or of both, from which each particle "
                  "takes its own",
       .standard = "none"},
      body.field);
}

bool takes_field(const BodyConfig& body, const Config& config) {
  return !own_parameters(state_variables(config.materials[body.material])).empty();
}

std::string read_body_grids(const BodyConfig& body, const Config& config, std::vector<NamedGrid>& grids) {
  const MaterialConfig& material = config.materials[body.material];
  const auto keys = own_parameters(state_variables(material));
  for (const std::string& key : own_parameters(state_variables(material.model))) {
    const bool needed = key == "young" && needs_own_young(material);
    if (!needed && !has_dataset(body.field, key)) continue;
    if (!is_one_of(keys, key)) return "a file without " + key + ", or -" + material.name + "_young field";
    NamedGrid& named = grids.emplace_back(NamedGrid{key, {}});
    if (const std::string fault = read_field(body.field, key, config.dim, named.grid); !fault.empty())
      return fault;
  }
  if (!grids.empty()) return "";
  GridField none;
  return read_field(body.field, keys.front(), config.dim, none);
}

void check_body_field(OptionReader& in, const MeshConfig& mesh, const Config& config, BodyConfig& body) {
  const std::string option = body.name + "_field";
  const MaterialConfig& material = config.materials[body.material];
  if (body.field.empty()) {
    if (needs_own_young(material) && body.shape.kind != ShapeKind::particles)
      in.reject(material.name + "_young", "a number in Pa where body " + body.name + " has no -" + option);
    return;
  }
  if (const std::string fault = takes_no_field(material); !fault.empty()) return in.reject(option, fault);
  std::vector<NamedGrid> grids;
  std::string fault = read_body_grids(body, config, grids);
  const auto keys = own_parameters(state_variables(material));
  const Bounds bounds = bounds_of(body.shape, mesh, config.dim);
  for (const auto& [key, grid] : grids) {
    if (fault.empty()) fault = uncovered(grid, bounds, 1e-9 * mesh.spacing);
    if (!fault.empty()) break;
    const auto [least, largest] = std::minmax_element(grid.values.begin(), grid.values.end());
    fault = own_parameter_fault(material, key, *least, *largest);
    body.largest_own[std::find(keys.begin(), keys.end(), key) - keys.begin()] = *largest;
  }
  if (!fault.empty()) return in.reject(option, fault);
  check_field_starts(in, body, material, bounds, config.dim, grids);
}

}  // namespace mpm
