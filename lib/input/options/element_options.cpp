// -element_path: a single material point in lieu of a mesh. A deck for it needs one material.

#include <algorithm>
#include <string_view>

#include "common/material_table.hpp"
#include "common/text.hpp"
#include "element/path_file.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr double k_point_cell = 1;  // m, edge of the cells for which a point stands, unless the law has it

/// The options of a run of a mesh that are given, which a single point does not use.
void pass_over_mesh(OptionReader& in) {
  InputReport report;
  OptionReader all;
  all.list(report);
  list_all(all);
  std::vector<std::string> beginnings;
  for (const char* list : {"bodies", "rigid_bodies", "water_regions", "probes"})
    for (const std::string& name : split(in.given_text(list)))
      if (!name.empty()) beginnings.push_back(name + "_");
  const int count = in.pass_over(all.known(), beginnings);
  if (count > 0)
    in.warn("element_path",
            "so " + std::to_string(count) + " options of the mesh, its bodies and its run are not used");
}

/// yz and zx are components of 3D alone. Where no -dim is given, the path decides it.
void choose_dim(OptionReader& in, Config& config) {
  const ElementConfig& path = config.element;
  bool spatial = path.stress[4] != 0 || path.stress[5] != 0;
  for (const ElementRow& row : path.rows)
    for (int c = 4; c < 6; ++c)
      spatial |= row.value[c] != 0 || row.drive[c] == Drive::stress || row.drive[c] == Drive::free;
  if (!spatial || config.dim == 3) return;
  if (in.given("dim"))
    in.reject("dim", "3, for the path in " + path.file + " has yz or zx");
  else
    config.dim = 3;
}

/// Whether a file that goes on from a state must give a state variable: one that frames have, but for a gap,
/// which is closed where the file does not give it.
bool is_needed(const StateVariable& variable) {
  return variable.output && std::string_view(variable.name) != "parted_volume";
}

/// Whether the law of a sound material can start where the path does. A file that gives all state variables
/// that frames have goes on from a state, as particles of a file do.
void check_start_of_path(OptionReader& in, Config& config) {
  const ElementConfig& path = config.element;
  const double pressure = -(path.stress[0] + path.stress[1] + path.stress[2]) / 3;
  MaterialConfig& material = config.materials[0];
  // The point stands for cells of the size to which parameters of softening refer.
  const double cell = parameter_of(material, "xi95_cell");
  prepare_material(material, cell > 0 ? cell : k_point_cell, std::max(0.0, pressure));
  const auto variables = state_variables(material);
  bool all_given = !path.state.empty();
  for (std::size_t k = 0; k < variables.size(); ++k)
    all_given &= !is_needed(variables[k]) ||
                 std::any_of(path.state.begin(), path.state.end(),
                             [k](const auto& given) { return given.first == static_cast<int>(k); });
  if (!all_given) check_element_start(in, material, path.height, path.stress);
}

}  // namespace

bool read_element_file(OptionReader& in, ElementConfig& element) {
  in.section("Single material point");
  in.text(
      {.name = "element_path",
       .meaning = "drives a single point of the material along the path in this CSV file, in lieu of a mesh, "
                  "and writes element.csv: docs/elements.md",
       .standard = in.listing() ? "none" : ""},
      element.file);
  if (const auto only = in.where("element_path"); in.listing() || in.given("element_path")) {
    in.integer({.name = "element_parts",
                .meaning = "equal parts in which each row of the path is done",
                .unit = "-",
                .range = {.lowest = 1, .highest = 1e6}},
               element.parts);
    in.number({.name = "element_height",
               .meaning = "height of the point, for parameters that grow with depth",
               .unit = "m",
               .range = k_coordinate},
              element.height);
  } else {
    in.not_taken("element_parts", "there is no -element_path");
    in.not_taken("element_height", "there is no -element_path");
  }
  return in.given("element_path");
}

void read_element(OptionReader& in, Config& config) {
  const auto errors = in.errors();
  read_only_material(in, config);
  ElementConfig& path = config.element;
  if (in.errors() == errors && needs_own_young(config.materials[0]))
    in.reject(config.materials[0].name + "_young", "a number in Pa with -element_path, which has no field");
  if (in.errors() == errors && !path.file.empty()) {
    const std::string fault = read_path(path.file, state_variables(config.materials[0]), path);
    if (!fault.empty()) in.reject("element_path", fault);
  }
  if (in.errors() == errors && !path.file.empty()) {
    choose_dim(in, config);
    make_law_object(in, MeshConfig{.spacing = k_point_cell}, config.dim, config.materials[0]);
  }
  if (in.errors() == errors && !path.file.empty()) {
    check_start_of_path(in, config);
  }
  pass_over_mesh(in);
}

}  // namespace mpm
