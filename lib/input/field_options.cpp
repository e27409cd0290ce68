// A body whose particles take a strength from a field.

#include <algorithm>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "input/field_file.hpp"
#include "input/groups.hpp"

namespace mpm {

void read_body_field(OptionReader& in, const std::string& name, bool listed, BodyConfig& body) {
  if (listed && !in.listing())
    return in.not_taken(name + "_field", "the particles are those of " + name + "_file");
  in.text({.name = name + "_field",
           .meaning =
               "HDF5 file with a grid of the strength of the material's law by its key, su or cohesion, from "
               "which each particle takes its own",
           .standard = "none"},
          body.field);
}

std::string field_key(const BodyConfig& body, const Config& config) {
  return own_parameter(state_variables(config.materials[body.material]));
}

void check_body_field(OptionReader& in, const MeshConfig& mesh, const Config& config, BodyConfig& body) {
  if (body.field.empty()) return;
  const std::string option = body.name + "_field", key = field_key(body, config);
  const MaterialConfig& material = config.materials[body.material];
  if (key.empty())
    return in.reject(option,
                     "nothing here: the model " + material.model + " has no strength of each particle");
  GridField field;
  std::string fault = read_field(body.field, key, config.dim, field);
  if (fault.empty()) fault = uncovered(field, bounds_of(body.shape, mesh, config.dim), 1e-9 * mesh.spacing);
  double least = 0, largest = 0;
  if (fault.empty()) {
    const auto [low, high] = std::minmax_element(field.values.begin(), field.values.end());
    least = *low, largest = *high;
    fault = own_parameter_fault(material, key, least, largest);
  }
  if (!fault.empty()) return in.reject(option, fault);
  body.largest_own_parameter = largest;
}

}  // namespace mpm
