// Shapes against the mesh.

#include <algorithm>
#include <cmath>

#include "common/host_memory.hpp"
#include "common/text.hpp"
#include "input/geometry/cut_cells.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/ground_options.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr double k_most_particles = 2147483647;  // they are numbered by int

bool is_round(const Shape& shape) {
  return shape.kind == ShapeKind::disc || shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone;
}

/// Whether sides of the mesh that are planes of symmetry may cut the shape at all.
bool may_be_cut(const Shape& shape) {
  return is_round(shape) || (shape.kind == ShapeKind::box && shape.angle == 0);
}

/// The option that places the lower or upper side of a shape in direction d.
std::string placing_option(const Shape& shape, const std::string& name, int dim, int d, bool lower) {
  if (is_round(shape)) return name + "_centre";
  if (shape.kind == ShapeKind::stl) return name + "_file";
  if (shape.kind == ShapeKind::polygon) return name + (dim == 3 && d == 1 ? "_width" : "_polygon");
  return name + (shape.angle != 0 ? "_angle_deg" : lower ? "_lower" : "_upper");
}

/// Whether the side is a plane of symmetry that leaves the half of a disc, a ball or what turns about an axis
/// on which its centre is.
bool is_cut_well(const Shape& shape, const MeshConfig& mesh, int dim, int d, int side) {
  if (!may_be_cut(shape) || mesh.walls[d][side] != Wall::roller || mesh.sides[d][side].moves) return false;
  const bool along_axis = shape.kind != ShapeKind::disc && d == dim - 1;
  if (!is_round(shape) || along_axis) return true;
  const double slack = 1e-9 * mesh.spacing;
  return side == 0 ? shape.centre[d] >= mesh.lower[d] - slack : shape.centre[d] <= mesh.upper[d] + slack;
}

/// A plane of symmetry that goes through rounded corners would leave a notch.
void check_cut_fillet(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                      const Cuts& cuts, int dim) {
  if (shape.kind != ShapeKind::box) return;
  for (int d = 0; d < dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const double beyond = side == 0 ? mesh.lower[d] - shape.lower[d] : shape.upper[d] - mesh.upper[d];
      if (cuts[d][side] && shape.fillet > beyond * (1 + 1e-9))
        return in.reject(name + "_fillet", "a length in m at most " + text_of(beyond) +
                                               ", by which the box goes beyond the mesh in " + "xyz"[d]);
    }
}

/// A closed surface that does not cross itself may still have one part within another, or one that is inside
/// out: no cell may hold more than itself, or less than nothing.
bool check_overlaps(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh) {
  if (shape.kind != ShapeKind::stl) return true;
  CellGrid grid{.origin = mesh.lower, .edge = mesh.spacing};
  const Bounds bounds = bounds_of(shape, mesh, 3);
  for (int d = 0; d < 3; ++d) {
    grid.first[d] = std::lround(std::floor((bounds.lower[d] - mesh.lower[d]) / mesh.spacing));
    grid.last[d] = std::lround(std::ceil((bounds.upper[d] - mesh.lower[d]) / mesh.spacing));
  }
  const double free = free_host_memory();  // a shape that does not fit is reported with all memory needed
  if (free > 0 && static_cast<double>(grid.columns()) * k_column_bytes > free / 2) return true;
  const auto cell = overfull_cell(Facets(shape, mesh, 3, mesh.spacing), grid);
  if (cell)
    in.reject(name + "_file", "a surface whose parts do not lie in each other and all face outwards; near " +
                                  text_of(*cell, 3) + " it encloses space twice, or from outside");
  return !cell;
}

}  // namespace

void check_shape(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                 int dim) {
  for (std::size_t k = 0; k < shape.parts.size(); ++k)
    check_shape(in, shape.part_names[k], shape.parts[k], mesh, dim);
  if (shape.kind == ShapeKind::parts) return;
  if (shape.kind == ShapeKind::layer && !check_layer(in, name, shape, mesh, dim)) return;
  const Cuts cuts = cuts_of(shape, mesh, dim);
  for (int d = 0; d < dim; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!cuts[d][side] || is_cut_well(shape, mesh, dim, d, side)) continue;
      const std::string cut = !may_be_cut(shape) ? ""
                              : is_round(shape)
                                  ? ", or cut by a side that is a roller and not beyond its centre"
                                  : ", or cut by a side that is a roller";
      return in.reject(placing_option(shape, name, dim, d, side == 0), "a shape wholly inside the mesh, " +
                                                                           text_of(mesh.lower, dim) + " to " +
                                                                           text_of(mesh.upper, dim) + cut);
    }
  check_cut_fillet(in, name, shape, mesh, cuts, dim);
  // A shape that does not fit into memory is reported with all memory that the run needs.
  if (const double free = free_host_memory(); free > 0 && fill_bytes(shape, mesh, dim) > free / 2) return;
  if (!check_overlaps(in, name, shape, mesh)) return;
  if (!holds_particle(shape, mesh, dim))
    in.reject(name + "_shape", shape.fill == Fill::cell ? "a shape that a whole cell of the mesh fits in"
                                                        : "a shape that holds a particle of the lattice");
}

void check_cut_out(OptionReader& in, const MeshConfig& mesh, const Config& config, const BodyConfig& body) {
  const std::string option = body.name + "_cut_out";
  for (const int other : body.cut_out_bodies) {
    const BodyConfig& cutter = config.bodies[other];
    const auto& back = cutter.cut_out_bodies;
    if (cutter.shape.kind == ShapeKind::particles)
      return in.reject(option,
                       "rigids and bodies that have a shape; " + cutter.name + " is a list of particles");
    if (std::any_of(back.begin(), back.end(), [&](int b) { return config.bodies[b].name == body.name; }))
      return in.reject(option, "bodies that are not cut by " + body.name + "; " + cutter.name + " is");
  }
  const bool listed = body.shape.kind == ShapeKind::particles;
  const double cells =
      listed ? 0 : shape_volume(body.shape, mesh, config.dim) / std::pow(mesh.spacing, config.dim);
  const bool too_many = cells * std::pow(body.shape.particles_per_cell, config.dim) > k_most_particles;
  // Too many particles are reported with the memory that they need.
  if ((body.cut_out.empty() && body.cut_out_bodies.empty()) || too_many) return;
  bool left = false;
  if (listed) {
    ParticleTable table;
    read_particles(source_of(body), mesh, config.dim, table);
    cut_particles(cut_out_of(config, body), mesh, config.dim, table);
    left = !table.position.empty();
  } else {
    left = holds_particle(body.shape, mesh, config.dim, cut_out_of(config, body));
  }
  if (!left) in.reject(option, "shapes that leave a particle of " + body.name);
}

}  // namespace mpm
