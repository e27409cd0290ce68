#include "input/files/checkpoint_particles.hpp"

#include <algorithm>
#include <cmath>

#include "checkpoint/checkpoint.hpp"
#include "checkpoint/sealed_file.hpp"
#include "common/material_table.hpp"
#include "common/text.hpp"
#include "mesh/background.hpp"

namespace mpm {
namespace {

constexpr double k_most_cells = 1 << 30;  // in a direction

/// The text of an option in the checkpoint's run; empty if there is none.
std::string value_of(const Checkpoint& c, const std::string& name) {
  for (const EffectiveOption& option : c.options)
    if (option.name == name) return option.value;
  return "";
}

/// Reads the mesh of the checkpoint's run; false where its options do not give it.
bool read_mesh(const Checkpoint& c, MeshConfig& mesh) {
  const auto vector = [&](const char* name, Vec3& to) {
    const auto pieces = split(value_of(c, name));
    if (static_cast<int>(pieces.size()) != c.dim) return false;
    for (int d = 0; d < c.dim; ++d) {
      const auto number = parse_number(pieces[d]);
      if (!number) return false;
      to[d] = *number;
    }
    return true;
  };
  const auto spacing = parse_number(value_of(c, "-mesh_spacing"));
  if (!vector("-mesh_lower", mesh.lower) || !vector("-mesh_upper", mesh.upper) || !spacing || !(*spacing > 0))
    return false;
  mesh.spacing = *spacing;
  for (int d = 0; d < c.dim; ++d) {
    const double cells = std::round((mesh.upper[d] - mesh.lower[d]) / mesh.spacing);
    if (!(cells >= 1 && cells <= k_most_cells)) return false;
    mesh.cells[d] = static_cast<int>(cells);
  }
  return true;
}

/// The cell of an address (patch number in the grid with its ring, times cells of a patch, plus place).
std::array<long, 3> cell_of(long address, const MeshConfig& mesh, int dim) {
  const int edge = patch_edge(dim);
  long in_patch = 1;
  for (int d = 0; d < dim; ++d) in_patch *= edge;
  long patch = address / in_patch, place = address % in_patch;
  std::array<long, 3> cell{};
  for (int d = 0; d < dim; ++d) {
    const long patches = (mesh.cells[d] + edge - 1) / edge + 2;  // with the ring outside
    cell[d] = (patch % patches - 1) * edge + place % edge;
    patch /= patches, place /= edge;
  }
  return cell;
}

/// A coordinate in the cell of an address becomes a place [m].
void put_in_mesh(long address, const MeshConfig& mesh, int dim, double* x) {
  const auto cell = cell_of(address, mesh, dim);
  for (int d = 0; d < dim; ++d) x[d] = mesh.lower[d] + (cell[d] + x[d]) * mesh.spacing;
}

/// The rows of a body's particles in the fields of a checkpoint.
struct BodyRows {
  const SavedPoints& soil;
  std::vector<std::size_t> rows{};
  std::string fault{};

  const SavedField* find(const char* name, int components) const {
    for (const SavedField& field : soil.fields)
      if (field.name == name && field.components == components &&
          field.values.size() == soil.address.size() * components)
        return &field;
    return nullptr;
  }
  bool has(const char* name, int components) const { return find(name, components) != nullptr; }
  std::vector<double> read(const char* name, int components) {
    const SavedField* const field = find(name, components);
    std::vector<double> values;
    if (field == nullptr && fault.empty())
      fault = std::string("a checkpoint with soil/") + name + "; one of an earlier version has none";
    if (field == nullptr) return values;
    for (const std::size_t row : rows)
      for (int k = 0; k < components; ++k) values.push_back(field->values[row * components + k]);
    if (!std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }))
      fault = std::string("a checkpoint with a sound soil/") + name;
    return values;
  }
};

/// The rows of the body of this name.
std::string find_body(const Checkpoint& c, const std::string& name, BodyRows& body) {
  const auto names = split(value_of(c, "-bodies"));
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return "a checkpoint with the body " + name + "; it has " + join(names, ", ");
  const SavedField* const bodies = body.find("body", 1);
  if (bodies == nullptr) return "a checkpoint with a sound soil/body";
  for (std::size_t p = 0; p < bodies->values.size(); ++p)
    if (bodies->values[p] == static_cast<double>(found - names.begin())) body.rows.push_back(p);
  return body.rows.empty() ? "a checkpoint with particles of " + name : "";
}

/// The state variables of a body's law.
std::vector<StateVariable> variables_of(const Checkpoint& c, const std::string& body) {
  return state_variables(value_of(c, "-" + value_of(c, "-" + body + "_material") + "_model"));
}

/// The field of a checkpoint that holds a state variable of a body: by its name, or where the laws of several
/// bodies share columns, by its place in the table of the body's law. Empty where the body has no such one.
std::string column_of(const Checkpoint& c, const std::string& body, const std::string& name,
                      const BodyRows& rows) {
  if (name == k_excess_pore_pressure) return rows.has(k_excess_pore_pressure, 1) ? name : "";
  const auto variables = variables_of(c, body);
  for (std::size_t k = 0; k < variables.size(); ++k) {
    if (name != variables[k].name) continue;
    return rows.has(name.c_str(), 1) ? name : "column_" + std::to_string(k);
  }
  return "";
}

/// Column of the variable that is each particle's own value of a parameter; empty where the body's particles
/// had no values of their own.
std::string column_of_own(const Checkpoint& c, const std::string& body, const std::string& parameter,
                          const BodyRows& rows) {
  const std::string note = own_parameter_words(parameter);
  const auto has_note = [&](const char* key) {
    return (value_of(c, "-" + body + key) + ",").find(note + ",") != std::string::npos;
  };
  if (!(has_note("_file") || has_note("_field"))) return "";
  for (const StateVariable& variable : variables_of(c, body))
    if (variable.parameter != nullptr && parameter == variable.parameter)
      return column_of(c, body, variable.name, rows);
  return "";
}

/// Reads a column of a body. scale: the cell's edge of the checkpoint's run over that of this one.
void read_column(BodyRows& body, const ParticleColumn& column, int dim, double scale, ParticleTable& table) {
  const int width = width_of(column.width, dim, 0);
  const bool optional = column.carried == Carried::checkpoints || column.carried == Carried::if_needed;
  if (optional && !body.has(column.saved, width)) return;
  std::vector<double>& values = table.*column.values;
  values = body.read(column.saved, width);
  if (column.per_cell == 0) return;
  const double factor = std::pow(scale, -column.per_cell);
  for (double& value : values) value *= factor;
}

}  // namespace

std::string read_checkpoint_particles(const ParticleSource& source, const MeshConfig& mesh, int dim,
                                      ParticleTable& table) {
  Checkpoint c;
  std::string fault;
  if (check_seal(PETSC_COMM_SELF, source.path, &fault) != PETSC_SUCCESS) return "a file that can be read";
  if (fault.empty()) fault = read_items(source.path, 0, 1, c);
  if (!fault.empty()) return fault;
  if (c.dim != dim) return "a checkpoint of a run in " + std::to_string(dim) + "D";
  MeshConfig there;
  BodyRows body{c.state.soil};
  if (!read_mesh(c, there)) return "a checkpoint whose options give its mesh";
  if (fault = find_body(c, source.group, body); !fault.empty()) return fault;

  for (const ParticleColumn& column : k_particle_columns)
    if (wanted(column, source)) read_column(body, column, dim, there.spacing / mesh.spacing, table);
  for (std::size_t p = 0; p < table.position.size() / dim; ++p)
    put_in_mesh(c.state.soil.address[body.rows[p]], there, dim, &table.position[p * dim]);
  for (const std::string& name : source.state) {
    const std::string column = column_of(c, source.group, name, body);
    if (!column.empty()) table.state.push_back({name, body.read(column.c_str(), 1)});
  }
  for (const std::string& key : source.parameters)
    if (const auto own = column_of_own(c, source.group, key, body); !own.empty())
      table.own_parameters.push_back({key, body.read(own.c_str(), 1)});
  if (source.stress && body.has(k_excess_pore_pressure, 1))
    add_pressure(body.read(k_excess_pore_pressure, 1), dim, table.stress);
  table.origin = "checkpoint of step " + std::to_string(c.run.step) + ", " + text_of(c.run.time) + " s";
  return body.fault;
}

std::vector<double> positions_of(const SavedPoints& points, const MeshConfig& mesh, int dim) {
  std::vector<double> position;
  for (const SavedField& field : points.fields)
    if (field.name == "coordinate") position = field.values;
  for (std::size_t p = 0; p < position.size() / dim; ++p)
    put_in_mesh(points.address[p], mesh, dim, &position[p * dim]);
  return position;
}

}  // namespace mpm
