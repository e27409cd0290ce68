#include "output/run_options.hpp"

#include <algorithm>
#include <sstream>

#include "output/files.hpp"
#include "output/numbers.hpp"

namespace mpm {
namespace {

std::string word(Backend v) { return v == Backend::cuda ? "cuda" : v == Backend::openmp ? "openmp" : "serial"; }
std::string word(Precision v) { return v == Precision::single ? "single" : "double"; }
std::string word(Wall v) { return v == Wall::fixed ? "fixed" : v == Wall::free ? "free" : "roller"; }
std::string word(ShapeKind v) { return v == ShapeKind::polygon ? "polygon" : v == ShapeKind::disc ? "disc" : "box"; }
std::string word(Progress v) { return v == Progress::on ? "on" : v == Progress::off ? "off" : "auto"; }
std::string word(Motion v) {
  return v == Motion::prescribed ? "prescribed" : v == Motion::dynamic ? "dynamic" : "fixed";
}
std::string word(P2G v) {
  constexpr const char* words[] = {"sequential", "atomic", "mosaic", "gather", "tile", "auto"};
  return words[static_cast<int>(v)];
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

/// Collects the lines of the things that have names.
template <class Named>
std::string names_of(const std::vector<Named>& things) {
  std::vector<std::string> names;
  for (const Named& thing : things) names.push_back(thing.name);
  return joined(names);
}

/// Builds lines under one prefix ("" or "NAME_").
struct Lines {
  std::vector<OptionLine>& lines;
  int dim;
  std::string prefix;

  void text(const char* name, const std::string& value, const char* unit = "") const {
    lines.push_back({prefix + name, value, unit, false});
  }
  void number(const char* name, double value, const char* unit) const { text(name, text_of(value), unit); }
  void vector(const char* name, const Vec3& value, const char* unit) const {
    std::vector<std::string> words;
    for (int d = 0; d < dim; ++d) words.push_back(text_of(value[d]));
    text(name, joined(words), unit);
  }
};

void add_run(const Config& c, const Lines& to) {
  to.text("dim", std::to_string(c.dim));
  to.text("backend", word(c.backend));
  to.text("precision", word(c.precision));
  to.text("p2g", word(c.p2g.strategy));
  to.number("p2g_margin", c.p2g.margin, "cells");
  to.text("p2g_mosaic_cells", std::to_string(c.p2g.mosaic_cells), "cells");
  if (c.p2g.rebuild_interval) to.text("p2g_rebuild_interval", std::to_string(*c.p2g.rebuild_interval), "steps");
  to.vector("gravity", c.gravity, "m/s2");
  to.number("time_end", c.time.end, "s");
  if (c.time.step) to.number("time_step", *c.time.step, "s");
  else to.number("time_courant", c.time.courant, "-");
  if (c.time.max_steps) to.text("time_max_steps", std::to_string(*c.time.max_steps), "steps");
  to.number("damping", c.damping, "-");
  to.number("flip_share", c.flip_share, "-");
}

void add_mesh(const MeshConfig& mesh, const Lines& to) {
  to.vector("mesh_lower", mesh.lower, "m");
  to.vector("mesh_upper", mesh.upper, "m");
  to.number("mesh_spacing", mesh.spacing, "m");
  constexpr const char* sides[3][2] = {{"mesh_xmin", "mesh_xmax"}, {"mesh_ymin", "mesh_ymax"}, {"mesh_zmin", "mesh_zmax"}};
  for (int d = 0; d < to.dim; ++d)
    for (int side = 0; side < 2; ++side) to.text(sides[d][side], word(mesh.walls[d][side]));
}

void add_shape(const Shape& shape, const Lines& to) {
  to.text("shape", word(shape.kind));
  if (shape.kind == ShapeKind::box) {
    to.vector("lower", shape.lower, "m");
    to.vector("upper", shape.upper, "m");
    to.number("fillet", shape.fillet, "m");
  } else if (shape.kind == ShapeKind::polygon) {
    std::vector<std::string> words;
    for (const auto& corner : shape.polygon)
      for (double coordinate : corner) words.push_back(text_of(coordinate));
    to.text("polygon", joined(words), "m");
  } else {
    to.vector("centre", shape.centre, "m");
    to.number("radius", shape.radius, "m");
  }
  to.text("particles_per_cell", std::to_string(shape.particles_per_cell));
  to.text("fill", shape.fill == Fill::cell ? "cell" : "centre");
}

void add_rigid(const RigidConfig& rigid, const Lines& to) {
  add_shape(rigid.shape, to);
  to.text("motion", word(rigid.motion));
  if (rigid.motion != Motion::fixed) to.vector("velocity", rigid.velocity, "m/s");
  if (rigid.motion == Motion::dynamic) {
    to.number("density", rigid.density, "kg/m3");
    to.vector("force", rigid.force, "N");
  }
  if (rigid.has_shear_limit || !rigid.friction) to.number("shear_limit", rigid.shear_limit, "Pa");
  if (rigid.friction) to.number("friction", *rigid.friction, "-");
}

void add_things(const Config& config, const std::vector<OptionLine>& material_parameters, const Lines& to) {
  to.text("materials", names_of(config.materials));
  for (const MaterialConfig& material : config.materials) {
    const Lines own{to.lines, to.dim, material.name + "_"};
    own.text("model", material.model);
    own.number("density", material.density, "kg/m3");
    for (const OptionLine& line : material_parameters)
      if (line.name.starts_with(own.prefix)) to.lines.push_back(line);
  }
  to.text("bodies", names_of(config.bodies));
  for (const BodyConfig& body : config.bodies) {
    const Lines own{to.lines, to.dim, body.name + "_"};
    own.text("material", config.materials.at(body.material).name);
    add_shape(body.shape, own);
    own.vector("velocity", body.velocity, "m/s");
  }
  to.text("rigids", names_of(config.rigids));
  for (const RigidConfig& rigid : config.rigids) add_rigid(rigid, {to.lines, to.dim, rigid.name + "_"});
}

/// The words of PETSc's options database as lines, all given.
PetscErrorCode database_lines(std::vector<OptionLine>* lines) {
  PetscFunctionBeginUser;
  char* all = nullptr;
  PetscCall(PetscOptionsGetAll(nullptr, &all));
  std::istringstream words(all);
  PetscCall(PetscFree(all));
  for (std::string word; words >> word;) {
    const bool is_name = word.size() > 1 && word[0] == '-' && !(word[1] >= '0' && word[1] <= '9') && word[1] != '.';
    if (is_name) lines->push_back({word.substr(1), "", "", true});
    else if (!lines->empty()) lines->back().value += (lines->back().value.empty() ? "" : " ") + word;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace

PetscErrorCode options_in_force(const Config& config, const std::vector<OptionLine>& material_parameters,
                                std::vector<OptionLine>* lines) {
  PetscFunctionBeginUser;
  const Lines to{*lines, config.dim, ""};
  lines->clear();
  add_run(config, to);
  add_mesh(config.mesh, to);
  add_things(config, material_parameters, to);
  to.text("output_dir", config.output.directory);
  to.number("output_interval", config.output.interval, "s");
  to.number("history_interval", config.output.history_interval, "s");
  to.text("progress", word(config.output.progress));

  std::vector<OptionLine> given;
  PetscCall(database_lines(&given));
  for (const OptionLine& line : given) {
    const auto same = std::find_if(lines->begin(), lines->end(), [&](const auto& l) { return l.name == line.name; });
    if (same != lines->end()) same->given = true;
    else lines->push_back(line);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::string format_options(const std::vector<OptionLine>& lines) {
  size_t name_width = 0, value_width = 0;
  for (const OptionLine& line : lines) {
    name_width = std::max(name_width, line.name.size());
    if (line.value.size() <= 24) value_width = std::max(value_width, line.value.size());
  }
  std::string text;
  for (const OptionLine& line : lines) {
    std::string row = "  -" + line.name + std::string(name_width - line.name.size() + 2, ' ') + line.value;
    const size_t missing = line.value.size() < value_width ? value_width - line.value.size() : 0;
    row += std::string(missing + 1, ' ') + line.unit;
    row += std::string(line.unit.size() < 6 ? 7 - line.unit.size() : 1, ' ') + (line.given ? "given" : "default");
    text += row + "\n";
  }
  return text;
}

PetscErrorCode write_options_json(const std::string& folder, const std::string& version,
                                  const std::vector<OptionLine>& lines) {
  PetscFunctionBeginUser;
  std::string text = "{\n  \"version\": " + quoted(version) + ",\n  \"options\": {";
  for (size_t k = 0; k < lines.size(); ++k)
    text += std::string(k ? "," : "") + "\n    " + quoted(lines[k].name) + ": " + quoted(lines[k].value);
  PetscCall(replace_text_file(folder + "/options.json", text + "\n  }\n}\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
