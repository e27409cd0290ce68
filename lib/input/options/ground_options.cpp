#include "input/options/ground_options.hpp"

#include <algorithm>

#include "common/text.hpp"
#include "input/files/raster_file.hpp"
#include "input/files/stl_file.hpp"
#include "input/geometry/height_surface.hpp"

namespace mpm {
namespace {

using Surface = std::shared_ptr<const HeightSurface>;

/// A level, or the vertices of a polyline; what they should have been.
std::string surface_of_numbers(const std::vector<double>& numbers, int dim, Surface& surface) {
  if (numbers.size() == 1) {
    surface = std::make_shared<const HeightSurface>(numbers[0]);
    return "";
  }
  const char* const form = dim == 2 ? "x0,y0,x1,y1,... in m" : "x0,z0,x1,z1,... in m";
  if (numbers.size() % 2 == 1 || numbers.size() < 4)
    return std::string("a level in m, or the vertices of a polyline as ") + form;
  std::vector<double> x, heights;
  for (std::size_t k = 0; k < numbers.size(); k += 2) {
    if (!x.empty() && !(numbers[k] > x.back()))
      return std::string("a polyline as ") + form + ", whose x grows; vertex " + std::to_string(k / 2 + 1) +
             " is at " + text_of({&numbers[k], 1}) + " and the one before at " + text_of({&x.back(), 1});
    x.push_back(numbers[k]), heights.push_back(numbers[k + 1]);
  }
  surface = std::make_shared<const HeightSurface>(std::move(x), std::vector<double>{}, std::move(heights));
  return "";
}

struct SurfaceOption {
  std::string name;
  bool top;
  const Shape* shape;  // that it belongs to
};

/// The base of the body above, or the top of the body below. False where that body is unsound itself.
bool share_surface(OptionReader& in, const SurfaceOption& option, const BodyConfig& other, Surface& surface) {
  if (other.shape.kind != ShapeKind::layer) {
    in.reject(option.name, "a body that is a layer; " + other.name + " is none");
    return false;
  }
  surface = option.top ? other.shape.base : other.shape.top;
  return surface != nullptr;
}

bool read_surface(OptionReader& in, const SurfaceOption& option, const Option& about, const Config& config,
                  Surface& surface, std::string& file) {
  const std::string takes =
      in.listing() ? "a level in m, a polyline x0,y0,x1,y1,... (x0,z0,... in 3D), a raster (3D) or a body"
      : config.dim == 2
          ? "a level in m, a polyline x0,y0,x1,y1,... or the name of a layer among the bodies before"
          : "a level in m, a polyline x0,z0,x1,z1,..., the file of a raster or the name of a layer "
            "among the bodies before";
  std::vector<std::string> pieces;
  if (!in.list_of(about, takes, pieces)) return false;
  std::vector<double> numbers;
  for (const auto& piece : pieces)
    if (const auto number = parse_number(piece)) numbers.push_back(*number);
  std::string fault;
  if (numbers.size() == pieces.size()) {
    fault = surface_of_numbers(numbers, config.dim, surface);
  } else if (pieces.size() > 1) {
    fault = takes;
  } else {
    for (const BodyConfig& other : config.bodies)
      if (lower_case(other.name) == lower_case(pieces[0]) && &other.shape != option.shape)
        return share_surface(in, option, other, surface);
    Raster raster;
    file = pieces[0];
    fault = config.dim == 2 ? takes : read_raster(file, raster);
    if (fault.empty()) {
      const long block = block_under_mesh(raster, config.mesh.spacing);
      surface = surface_of(raster, block);
      if (block > 1)
        in.note(option.name,
                formatted("%ld x %ld cells of %.6g m; each block of %ld x %ld of them counts as one, at "
                          "least 16 along the edge of a cell of the mesh",
                          raster.columns, raster.rows, raster.cell, block, block));
    }
  }
  if (!fault.empty()) in.reject(option.name, fault);
  return fault.empty();
}

}  // namespace

void read_stl_shape(OptionReader& in, const std::string& name, Shape& shape) {
  const auto errors = in.errors();
  if (!in.listing())  // listed with the particles'
    in.text({.name = name + "_file", .meaning = "", .required = true}, shape.file);
  const auto only = in.where(name + "_shape", {"stl"});
  double scale = 1;
  in.number({.name = name + "_scale",
             .meaning = "stl: what the file's lengths are multiplied by, as 0.001 where they are mm",
             .unit = "-",
             .range = k_positive},
            scale);
  Vec3 offset{};
  in.vector({.name = name + "_offset",
             .meaning = "stl: what is added to the file's coordinates, after the scale",
             .unit = "m",
             .range = {.lowest = -1e7, .highest = 1e7}},
            3, offset);
  if (in.listing() || in.errors() != errors) return;
  const std::string fault = read_stl(shape.file, scale, shape.triangles, offset);
  if (!fault.empty()) in.reject(name + "_file", fault);
}

bool read_layer(OptionReader& in, const std::string& name, const Config& config, Shape& shape) {
  const auto only = in.where(name + "_shape", {"layer"});
  const SurfaceOption top{name + "_top", true, &shape}, base{name + "_base", false, &shape};
  const bool has_top = read_surface(in, top,
                                    {.name = top.name,
                                     .meaning = "layer: its upper surface; of a body, the base of that layer",
                                     .required = true},
                                    config, shape.top, shape.top_file);
  const bool has_base = read_surface(in, base,
                                     {.name = base.name,
                                      .meaning = "layer: its lower surface; of a body, the top of that layer",
                                      .required = true},
                                     config, shape.base, shape.base_file);
  return has_top && has_base;
}

bool check_layer(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                 int dim) {
  for (const auto& [key, surface] : {std::pair{"_top", &shape.top}, std::pair{"_base", &shape.base}}) {
    const std::string fault = fault_of(**surface, mesh, dim);
    if (fault.empty()) continue;
    in.reject(name + key, fault);
    return false;
  }
  const auto crossing = crossing_of(*shape.top, *shape.base, mesh, dim);
  if (!crossing) return true;
  const std::string at = dim == 2 ? "x = " + text_of({&crossing->x, 1})
                                  : text_of(std::array<double, 2>{crossing->x, crossing->y});
  in.reject(name + "_base", "a surface nowhere above -" + name + "_top; at " + at +
                                formatted(" it is %.6g m above", crossing->height));
  return false;
}

}  // namespace mpm
