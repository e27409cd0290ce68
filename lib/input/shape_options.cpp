#include <algorithm>
#include <cmath>

#include "input/groups.hpp"
#include "input/polygon.hpp"
#include "input/shapes.hpp"
#include "input/text.hpp"

namespace mpm {
namespace {

void read_box(OptionReader& in, const std::string& name, int dim, Shape& shape) {
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
  if (in.listing() || in.errors() != errors) return;
  double shortest = shape.upper[0] - shape.lower[0];
  for (int d = 1; d < dim; ++d) shortest = std::min(shortest, shape.upper[d] - shape.lower[d]);
  if (!(shortest > 0))
    in.reject(name + "_upper", std::to_string(dim) + " numbers in m, each greater than that of -" + name +
                                   "_lower, " + text_of(shape.lower, dim));
  else if (shape.fillet > shortest / 2 * (1 + 1e-9))
    in.reject(name + "_fillet", "a length in m at most half of the shortest edge, " + text_of(shortest / 2));
}

void read_polygon(OptionReader& in, const std::string& name, Shape& shape) {
  const std::string option = name + "_polygon", takes = "x0,y0,x1,y1,... in m, 3 vertices or more";
  std::vector<std::string> pieces;
  if (!in.list_of(
          {.name = option, .meaning = "polygon: its vertices in order (2D)", .unit = "m", .required = true},
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

void read_disc(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  in.vector({.name = name + "_centre", .meaning = "disc: its centre", .unit = "m", .required = true}, dim,
            shape.centre);
  in.number({.name = name + "_radius",
             .meaning = "disc: its radius",
             .unit = "m",
             .range = k_positive,
             .required = true},
            shape.radius);
}

/// Reads what belongs to the kind of shape and rejects what belongs to another.
void read_geometry(OptionReader& in, const std::string& name, int dim, const std::string& word,
                   Shape& shape) {
  static const std::vector<std::pair<ShapeKind, std::vector<std::string>>> keys = {
      {ShapeKind::box, {"lower", "upper", "fillet"}},
      {ShapeKind::polygon, {"polygon"}},
      {ShapeKind::disc, {"centre", "radius"}}};
  for (const auto& [kind, of_kind] : keys) {
    const bool wanted = in.listing() || kind == shape.kind;
    if (wanted && kind == ShapeKind::box) read_box(in, name, dim, shape);
    if (wanted && kind == ShapeKind::polygon) read_polygon(in, name, shape);
    if (wanted && kind == ShapeKind::disc) read_disc(in, name, dim, shape);
    for (const auto& key : of_kind)
      if (!wanted) in.not_taken(name + "_" + key, name + " is a " + word);
  }
}

/// The kind of shape and its geometry; whether it is known, so that what was given for it has a meaning.
bool read_kind(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  static const std::vector<std::string> words = {"box", "polygon", "disc", "ball"};
  int kind = 0;
  const Option option{
      .name = name + "_shape", .meaning = "box, polygon (2D) or disc (ball in 3D)", .required = true};
  const bool known = in.word(option, words, kind);
  shape.kind = kind == 0 ? ShapeKind::box : kind == 1 ? ShapeKind::polygon : ShapeKind::disc;
  const bool fits = dim == 3 ? kind != 1 : kind != 3;
  if (known && !fits) in.reject(option.name, dim == 3 ? "box or ball in 3D" : "box, polygon or disc in 2D");
  if (!in.listing() && !(known && fits)) {
    for (const char* key : {"lower", "upper", "fillet", "polygon", "centre", "radius"})
      in.ignore(name + "_" + key);
    return false;
  }
  read_geometry(in, name, dim, words[kind], shape);
  return true;
}

/// The option that places a shape's lower or upper side.
std::string placing_option(const Shape& shape, const std::string& name, bool lower) {
  if (shape.kind == ShapeKind::box) return name + (lower ? "_lower" : "_upper");
  return name + (shape.kind == ShapeKind::polygon ? "_polygon" : "_centre");
}

}  // namespace

bool read_shape(OptionReader& in, const std::string& name, int dim, Shape& shape) {
  static const std::vector<std::pair<std::string, Fill>> fills = {{"centre", Fill::centre},
                                                                  {"cell", Fill::cell}};
  const auto errors = in.errors();
  read_kind(in, name, dim, shape);
  in.integer({.name = name + "_particles_per_cell",
              .meaning = "particles in each direction of a cell",
              .unit = "-",
              .range = {.lowest = 1, .highest = 16},
              .standard = in.listing() ? "2, for a rigid 4" : ""},
             shape.particles_per_cell);
  in.word({.name = name + "_fill",
           .meaning = "particles whose centre is in the shape, or those of cells that lie wholly in it"},
          fills, shape.fill);
  return !in.listing() && in.errors() == errors;
}

void check_shape(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                 int dim) {
  const Bounds bounds = bounds_of(shape, dim);
  const double slack = 1e-9 * mesh.spacing;
  for (int d = 0; d < dim; ++d) {
    const bool below = bounds.lower[d] < mesh.lower[d] - slack;
    if (!below && bounds.upper[d] <= mesh.upper[d] + slack) continue;
    return in.reject(
        placing_option(shape, name, below),
        "a shape wholly inside the mesh, " + text_of(mesh.lower, dim) + " to " + text_of(mesh.upper, dim));
  }
  if (!holds_particle(shape, mesh, dim))
    in.reject(name + "_shape", shape.fill == Fill::cell ? "a shape that a whole cell of the mesh fits in"
                                                        : "a shape that holds a particle of the lattice");
}

}  // namespace mpm
