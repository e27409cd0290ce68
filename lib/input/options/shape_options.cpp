#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/text.hpp"
#include "input/geometry/facets.hpp"
#include "input/geometry/polygon.hpp"
#include "input/options/ground_options.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// A word of -NAME_shape. Those that rigids do not take are the last.
struct Kind {
  const char* word;
  ShapeKind kind;
  bool in_2d, in_3d, for_rigids;
};
constexpr Kind k_kinds[] = {
    {"box", ShapeKind::box, true, true, true},
    {"polygon", ShapeKind::polygon, true, true, true},
    {"disc", ShapeKind::disc, true, true, true},
    {"ball", ShapeKind::disc, false, true, true},
    {"cylinder", ShapeKind::cylinder, false, true, true},
    {"cone", ShapeKind::cone, false, true, true},
    {"half_plane", ShapeKind::half_plane, true, true, true},
    {"stl", ShapeKind::stl, false, true, true},
    {"layer", ShapeKind::layer, true, true, true},
    {"particles", ShapeKind::particles, true, true, false},
};

/// The options that belong to each kind of shape.
const std::vector<std::pair<ShapeKind, std::vector<std::string>>> k_keys = {
    {ShapeKind::box, {"lower", "upper", "fillet", "angle_deg"}},
    {ShapeKind::polygon, {"polygon", "width"}},
    {ShapeKind::disc, {"centre", "radius"}},
    {ShapeKind::cylinder, {"centre", "radius", "height", "tip_angle_deg"}},
    {ShapeKind::cone, {"centre", "radius", "height", "tip_angle_deg", "tip"}},
    {ShapeKind::half_plane, {"point", "normal"}},
    {ShapeKind::stl, {"file", "scale", "offset"}},
    {ShapeKind::layer, {"top", "base"}},
    {ShapeKind::particles, {"file", "file_body"}}};

/// The shapes that have an option, by its key.
std::vector<std::string> shapes_with(const std::string& key) {
  std::vector<std::string> words;
  for (const Kind& k : k_kinds)
    for (const auto& [kind, keys] : k_keys)
      if (kind == k.kind && std::find(keys.begin(), keys.end(), key) != keys.end())
        words.emplace_back(k.word);
  return words;
}

void read_box(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  const auto only = in.where(name + "_shape", shapes_with("lower"));
  const auto errors = in.errors();
  in.vector({.name = name + "_lower", .meaning = "box: its lower corner", .unit = "m", .required = true}, dim,
            shape.lower);
  in.vector({.name = name + "_upper", .meaning = "box: its upper corner", .unit = "m", .required = true}, dim,
            shape.upper);
  in.number({.name = name + "_fillet",
             .meaning = "box: radius of all its corners (in 3D of its edges and corners)",
             .unit = "m",
             .range = k_not_negative},
            shape.fillet);
  double degrees = 0;
  in.number(
      {.name = name + "_angle_deg",
       .meaning = "box: turned about its lower corner, anticlockwise; in 3D about the y axis, from x to z",
       .unit = "deg",
       .range = {.lowest = -360, .highest = 360}},
      degrees);
  shape.angle = degrees / 180 * std::numbers::pi;
  if (in.listing() || in.errors() != errors) return;
  double shortest = shape.upper[0] - shape.lower[0];
  for (int d = 1; d < dim; ++d) shortest = std::min(shortest, shape.upper[d] - shape.lower[d]);
  if (!(shortest > 0))
    in.reject(name + "_upper", std::to_string(dim) + " numbers in m, each greater than that of -" + name +
                                   "_lower, " + text_of(shape.lower, dim));
  else if (shape.fillet > shortest / 2 * (1 + 1e-9))
    in.reject(name + "_fillet", "a length in m at most half of the shortest edge, " + text_of(shortest / 2));
}

void read_polygon(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  const auto only = in.where(name + "_shape", shapes_with("polygon"));
  const std::string option = name + "_polygon";
  const std::string takes = in.listing() ? "x0,y0,x1,y1,... (x0,z0,... in 3D) in m, 3 vertices or more"
                            : dim == 2   ? "x0,y0,x1,y1,... in m, 3 vertices or more"
                                         : "x0,z0,x1,z1,... in m, 3 vertices or more";
  std::vector<std::string> pieces;
  if (!in.list_of({.name = option,
                   .meaning = "polygon: its vertices in order; in 3D those of a prism along y",
                   .unit = "m",
                   .required = true},
                  takes, pieces))
    return;
  std::vector<double> numbers;
  for (const auto& piece : pieces)
    if (const auto number = parse_number(piece)) numbers.push_back(*number);
  if (numbers.size() != pieces.size() || numbers.size() % 2 == 1 || numbers.size() < 6)
    return in.reject(option, takes);
  for (std::size_t k = 0; k < numbers.size(); k += 2) shape.polygon.push_back({numbers[k], numbers[k + 1]});
  if (const auto crossing = first_crossing(shape.polygon))
    in.reject(option, "a polygon whose edges neither cross nor touch; edges " +
                          std::to_string(crossing->first + 1) + " and " +
                          std::to_string(crossing->second + 1) + " do");
}

void read_width(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  const std::string option = name + "_width";
  if (dim == 2 && !in.listing()) return in.not_taken(option, "a polygon in 2D has none");
  const auto polygon = in.where(name + "_shape", shapes_with("width"));
  const auto in_3d = in.where("dim", {"3"});
  const bool found = in.numbers({.name = option,
                                 .meaning = "polygon in 3D: lower and upper y of the prism",
                                 .unit = "m",
                                 .required = true},
                                "lower,upper", "", shape.width);
  if (found && !(shape.width[0] < shape.width[1]))
    in.reject(option, "2 numbers in m, as lower,upper, the second greater than the first");
}

void read_half_plane(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  const auto only = in.where(name + "_shape", shapes_with("point"));
  in.vector(
      {.name = name + "_point", .meaning = "half_plane: a point on its face", .unit = "m", .required = true},
      dim, shape.point);
  const bool found =
      in.vector({.name = name + "_normal",
                 .meaning = "half_plane: normal of its face, outward, of any length; the shape is "
                            "the part of the mesh behind the face",
                 .unit = "-",
                 .required = true},
                dim, shape.normal);
  const double length = std::hypot(shape.normal[0], shape.normal[1], shape.normal[2]);
  if (found && length == 0) in.reject(name + "_normal", std::to_string(dim) + " numbers that are not all 0");
  if (length > 0)
    for (double& component : shape.normal) component /= length;
}

void read_disc(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  const auto only = in.where(name + "_shape", shapes_with("centre"));
  in.vector({.name = name + "_centre",
             .meaning = "disc: its centre; cylinder: the lower end of its vertical axis; cone: its tip",
             .unit = "m",
             .required = true},
            dim, shape.centre);
  in.number({.name = name + "_radius",
             .meaning = "disc, cylinder: its radius; cone: that of its base",
             .unit = "m",
             .range = k_positive,
             .required = true},
            shape.radius);
}

/// A cone's height or apex angle: either gives the other.
void read_height(OptionReader& in, const std::string& name, Shape& shape) {
  const auto only = in.where(name + "_shape", shapes_with("height"));
  const bool cone = shape.kind == ShapeKind::cone && !in.listing();
  const std::string height = name + "_height", angle = name + "_tip_angle_deg";
  const bool by_angle = cone && in.given(angle);
  if (by_angle && in.given(height)) {
    in.ignore(height);
    return in.not_taken(angle, name + "_height is given");
  }
  if (!by_angle)
    in.number({.name = height,
               .meaning = "cylinder: its height, with its tip; cone: its height, or give its tip angle",
               .unit = "m",
               .range = k_positive,
               .required = !in.listing(),
               .standard = in.listing() ? "required, of a cone where its tip_angle_deg is not given" : ""},
              shape.height);
  double degrees = 180;
  const Range range = cone ? Range{.lowest = 1, .highest = 179} : Range{.lowest = 1, .highest = 180};
  if (by_angle || !cone)
    in.number({.name = angle,
               .meaning = "cylinder: apex angle of the cone that its lower end is, 180 for a flat end; cone: "
                          "its apex angle, instead of its height",
               .unit = "deg",
               .range = range},
              degrees);
  const double of_tip = degrees == 180 ? 0 : shape.radius / std::tan(degrees / 360 * std::numbers::pi);
  (cone ? (by_angle ? shape.height : shape.tip_height) : shape.tip_height) = of_tip;
}

void read_cylinder(OptionReader& in, const std::string& name, Shape& shape) {
  const auto errors = in.errors();
  read_height(in, name, shape);
  if (in.listing() || in.errors() != errors || shape.tip_height <= shape.height * (1 + 1e-9)) return;
  const double least = 360 / std::numbers::pi * std::atan(shape.radius / shape.height);
  in.reject(name + "_tip_angle_deg", "an angle in deg of " + text_of(least) +
                                         " or more, so that the tip is not longer than -" + name + "_height");
}

void read_cone(OptionReader& in, const std::string& name, Shape& shape) {
  if (!in.listing()) read_height(in, name, shape);  // listed with the cylinder's
  const auto only = in.where(name + "_shape", shapes_with("tip"));
  in.word({.name = name + "_tip", .meaning = "cone: where its tip points"},
          Words<bool>{{"down", false}, {"up", true}}, shape.tip_up);
}

void read_file(OptionReader& in, const std::string& name, Shape& shape) {
  {
    const auto only = in.where(name + "_shape", shapes_with("file"));
    in.text(
        {.name = name + "_file",
         .meaning = "particles: a frame or checkpoint of another run, or an HDF5 file laid out as a frame; "
                    "stl: a closed surface of triangles, STL (ASCII or binary) or OBJ",
         .required = true},
        shape.file);
  }
  shape.file_body = name;
  const auto only = in.where(name + "_shape", shapes_with("file_body"));
  in.text({.name = name + "_file_body",
           .meaning = "particles: the body of the file",
           .standard = in.listing() ? "NAME" : ""},
          shape.file_body);
}

/// Reads what belongs to the kind of shape and rejects what belongs to another. False where the shape lacks a
/// part that another body's mistake keeps from it.
bool read_geometry(OptionReader& in, const std::string& name, const Config& config, const std::string& word,
                   Shape& shape) {
  const int dim = config.dim;
  bool whole = true;
  std::set<std::string> taken;
  for (const auto& [kind, of_kind] : k_keys)
    if (kind == shape.kind) taken.insert(of_kind.begin(), of_kind.end());
  for (const auto& [kind, of_kind] : k_keys) {
    const bool wanted = in.listing() || kind == shape.kind;
    const bool revolved = kind == ShapeKind::cylinder || kind == ShapeKind::cone;
    if (wanted && kind == ShapeKind::box) read_box(in, name, dim, shape);
    if (wanted && kind == ShapeKind::polygon)
      read_polygon(in, name, dim, shape), read_width(in, name, dim, shape);
    if (wanted && (kind == ShapeKind::disc || (revolved && !in.listing()))) read_disc(in, name, dim, shape);
    if (wanted && kind == ShapeKind::cylinder) read_cylinder(in, name, shape);
    if (wanted && kind == ShapeKind::cone) read_cone(in, name, shape);
    if (wanted && kind == ShapeKind::half_plane) read_half_plane(in, name, dim, shape);
    if (wanted && kind == ShapeKind::stl) read_stl_shape(in, name, shape);
    if (wanted && kind == ShapeKind::layer) whole = read_layer(in, name, config, shape);
    if (wanted && kind == ShapeKind::particles) read_file(in, name, shape);
    for (const auto& key : of_kind)
      if (!wanted && taken.insert(key).second) in.not_taken(name + "_" + key, name + "_shape is " + word);
  }
  return whole;
}

/// Reads the kind of shape and its geometry. Returns whether the kind is valid, so that its other options
/// have a meaning.
bool read_kind(OptionReader& in, const std::string& name, const Config& config, bool listed, Shape& shape) {
  const int dim = config.dim;
  std::vector<std::string> words, fitting;
  for (const Kind& k : k_kinds) {
    if (!k.for_rigids && !listed) continue;
    words.push_back(k.word);
    if (dim == 2 ? k.in_2d : k.in_3d) fitting.push_back(k.word);
  }
  const Option option{
      .name = name + "_shape",
      .meaning =
          "box, polygon, disc (2D), ball, vertical cylinder or cone (3D), what is behind a plane, a closed "
          "surface of triangles (stl, 3D), the layer between two surfaces, or the particles of a file "
          "(bodies)",
      .required = true};
  int index = 0;
  bool known = false;
  if (const auto only = in.unless(name + "_parts"); true) known = in.word(option, words, index);
  const Kind& kind = k_kinds[index];
  shape.kind = kind.kind;
  const bool fits = dim == 2 ? kind.in_2d : kind.in_3d;
  if (known && !fits) in.reject(option.name, one_of(fitting) + " in " + std::to_string(dim) + "D");
  if (!in.listing() && !(known && fits)) {
    for (const auto& [other, keys] : k_keys)
      for (const auto& key : keys) in.ignore(name + "_" + key);
    return false;
  }
  return read_geometry(in, name, config, words[index], shape);
}

/// Reads the shapes of the parts of a rigid body, instead of its own.
bool read_parts(OptionReader& in, const std::string& name, const Config& config, Shape& shape) {
  const std::string given = name + "_parts is given";
  in.not_taken(name + "_shape", given);
  std::set<std::string> keys;
  for (const auto& [kind, of_kind] : k_keys) keys.insert(of_kind.begin(), of_kind.end());
  for (const std::string& key : keys) in.not_taken(name + "_" + key, given);
  shape.kind = ShapeKind::parts;
  bool whole = true;
  for (const std::string& part : shape.part_names) {
    Shape& of = shape.parts.emplace_back();
    whole = read_kind(in, part, config, /*listed*/ false, of) && whole;
    if (of.kind == ShapeKind::half_plane || of.kind == ShapeKind::layer)
      in.reject(part + "_shape", "a shape that ends in the mesh, for it is a part of " + name);
  }
  return whole;
}

/// Whether -contact_pairs names a body.
bool is_in_pairs(const OptionReader& in, const std::string& name) {
  std::string text = in.given_text("contact_pairs");
  std::replace(text.begin(), text.end(), ':', ',');
  const std::vector<std::string> names = split(text, ',');
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Which particles a shape has. Those of a rigid have one volume. A body that slides on another wants a face
/// without stairs.
void read_fill(OptionReader& in, const std::string& name, bool body, Shape& shape) {
  static const Words<Fill> fills = {{"centre", Fill::centre}, {"cell", Fill::cell}, {"cut", Fill::cut}};
  const bool ground =
      shape.kind == ShapeKind::stl || shape.kind == ShapeKind::layer || shape.kind == ShapeKind::parts;
  const bool slides = body && !in.listing() && has_facets(shape) && is_in_pairs(in, name);
  if ((body && ground) || slides) shape.fill = Fill::cut;
  std::vector<std::string> shapes;
  for (const Kind& k : k_kinds)
    if (k.for_rigids) shapes.emplace_back(k.word);
  const auto only = in.where(name + "_shape", shapes);
  in.word(
      {.name = name + "_fill",
       .meaning =
           "particles whose centre is in the shape, those of cells that lie wholly in it, or the parts of "
           "the particles' cells that are in it, each with its own volume (bodies)",
       .standard = in.listing()
                       ? "centre; of a body that is an stl or a layer, or in -contact_pairs: cut where "
                         "its shape can be"
                       : ""},
      fills, shape.fill);
  const std::string of_kind = " where " + name + "_shape is ";
  if (shape.fill == Fill::cut && !body)
    in.reject(name + "_fill", "centre or cell for a rigid body, whose particles have one volume");
  else if (shape.fill == Fill::cut && !has_facets(shape) && !in.listing())
    in.reject(name + "_fill", "centre or cell" + of_kind + in.given_text(name + "_shape"));
  else if (shape.fill == Fill::cell && ground)
    in.reject(name + "_fill", shape.kind == ShapeKind::parts ? "centre where " + name + "_parts is given"
                                                             : (body ? "centre or cut" : "centre") + of_kind +
                                                                   in.given_text(name + "_shape"));
}

}  // namespace

bool read_shape(OptionReader& in, const std::string& name, const Config& config, bool listed, Shape& shape) {
  const auto errors = in.errors();
  const bool whole = shape.part_names.empty() ? read_kind(in, name, config, listed, shape)
                                              : read_parts(in, name, config, shape);
  in.integer({.name = name + "_particles_per_cell",
              .meaning = "particles in each direction of a cell; of a file: their width is a cell's over it",
              .unit = "-",
              .range = {.lowest = 1, .highest = 16},
              .standard = in.listing() ? "2, for a rigid 4" : ""},
             shape.particles_per_cell);
  for (Shape& part : shape.parts) part.particles_per_cell = shape.particles_per_cell;
  if (shape.kind == ShapeKind::particles && !in.listing())
    in.not_taken(name + "_fill", "the particles are those of " + name + "_file");
  else
    read_fill(in, name, listed, shape);
  if (shape.angle != 0 && shape.fill == Fill::cell)
    in.reject(name + "_fill", "centre where " + name + "_angle_deg turns the box");
  return !in.listing() && in.errors() == errors && whole;
}

}  // namespace mpm
