#include "input/geometry/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/presence.hpp"
#include "input/geometry/cut_cells.hpp"
#include "input/geometry/height_surface.hpp"
#include "input/geometry/region.hpp"

namespace mpm {
namespace {

constexpr double k_slack = 1e-9;  // of the mesh spacing

/// A grid of equal squares (cubes) round a shape: particles' own for Fill::centre, the mesh's cells for
/// Fill::cell. That of a box turns with it; coordinates are those before it is turned. All are in the mesh,
/// which may cut the shape.
struct Sites {
  Vec3 origin{};
  double edge = 0;                      // m
  int particles = 1;                    // in each direction of a site
  double angle = 0;                     // rad, about the origin
  std::array<long, 3> first{}, last{};  // first <= k < last in each direction

  Sites(const Shape& shape, const MeshConfig& mesh, int dim) {
    const bool cells = shape.fill == Fill::cell, box = shape.kind == ShapeKind::box;
    const Bounds bounds = box && shape.angle != 0 ? Bounds{shape.lower, shape.upper}
                                                  : within(bounds_of(shape, mesh, dim), mesh, dim);
    origin = cells || !box ? mesh.lower : bounds.lower;
    edge = cells ? mesh.spacing : mesh.spacing / shape.particles_per_cell;
    particles = cells ? shape.particles_per_cell : 1;
    if (box && !cells) angle = shape.angle;
    last[2] = 1;
    for (int d = 0; d < dim; ++d) {
      const double from = (bounds.lower[d] - origin[d]) / edge, to = (bounds.upper[d] - origin[d]) / edge;
      first[d] = std::lround(std::floor(from - 0.5)), last[d] = std::lround(std::ceil(to + 0.5));
      if (angle != 0) continue;  // such a box lies wholly in the mesh
      const double low = (mesh.lower[d] - origin[d]) / edge, high = (mesh.upper[d] - origin[d]) / edge;
      first[d] = std::max(first[d], std::lround(std::ceil(low - 0.5 + k_slack)));
      last[d] = std::min(last[d], std::lround(std::ceil(high - 0.5 - k_slack)));
      last[d] = std::max(first[d], last[d]);
    }
  }
  /// The sites of a row that may be filled, some more at its ends.
  std::array<long, 2> range(const Region::Span& span) const {
    const auto site = [&](double x) {
      return std::lround(std::clamp((x - origin[0]) / edge, double(first[0]), double(last[0])));
    };
    return {std::max(first[0], site(span.from) - 2), std::min(last[0], site(span.to) + 2)};
  }
  /// Only part of the rows or layers.
  void cut(LatticePart part, int dim) {
    const long from = first[dim - 1], count = last[dim - 1] - from;
    first[dim - 1] = from + count * part.number / part.of;
    last[dim - 1] = from + count * (part.number + 1) / part.of;
  }
  Vec3 corner(long i, long j, long k, int dim) const {
    return {origin[0] + i * edge, origin[1] + j * edge, dim == 3 ? origin[2] + k * edge : 0};
  }
  /// Particle (a, b, c) of all, where it is.
  Vec3 particle(long a, long b, long c, int dim) const {
    const double spacing = edge / particles;
    return turned({origin[0] + (a + 0.5) * spacing, origin[1] + (b + 0.5) * spacing,
                   dim == 3 ? origin[2] + (c + 0.5) * spacing : 0},
                  origin, angle, dim);
  }
};

/// The base and the top of a layer at the middle of each column of sites [m]: evaluated once, not at every
/// level.
class LayerColumns {
 public:
  /// For a shape that is no layer, and for Fill::cell, every site may be filled.
  LayerColumns(const Shape& shape, int dim, const Sites& sites, double slack) : sites_(sites), up_(dim - 1) {
    if (shape.kind != ShapeKind::layer || shape.fill == Fill::cell) return;
    for (long j = sites.first[1]; j < (dim == 3 ? sites.last[1] : sites.first[1] + 1); ++j)
      for (long i = sites.first[0]; i < sites.last[0]; ++i) {
        const Vec3 x = sites.corner(i, j, 0, dim);
        const double y = dim == 3 ? x[1] + sites.edge / 2 : 0;
        columns_.push_back({shape.base->at(x[0] + sites.edge / 2, y) - slack,
                            shape.top->at(x[0] + sites.edge / 2, y) + slack});
      }
  }
  bool may_hold(long i, long j, double height) const {
    if (columns_.empty()) return true;
    const long row = up_ == 2 ? (j - sites_.first[1]) * (sites_.last[0] - sites_.first[0]) : 0;
    const auto& [low, high] = columns_[row + i - sites_.first[0]];
    return height >= low && height <= high;
  }

 private:
  const Sites& sites_;
  int up_;
  std::vector<std::array<double, 2>> columns_;
};

/// Calls visit(i, j, k) for each filled site, x fastest, until it returns true; returns whether it did.
template <class Visit>
bool any_site(const Shape& shape, const MeshConfig& mesh, int dim, const Sites& sites, Visit&& visit) {
  Region region(shape, dim, k_slack * mesh.spacing);
  const LayerColumns layer(shape, dim, sites, 2 * k_slack * mesh.spacing);
  for (long k = sites.first[2]; k < sites.last[2]; ++k)
    for (long j = sites.first[1]; j < sites.last[1]; ++j) {
      const Vec3 row = sites.corner(0, j, k, dim);
      region.enter_row(row[dim - 1], row[dim - 1] + sites.edge);
      const auto [from, to] = sites.range(region.span(row[1], row[1] + sites.edge));
      const double height = row[dim - 1] + sites.edge / 2;
      for (long i = from; i < to; ++i) {
        if (!layer.may_hold(i, j, height)) continue;
        Vec3 x = sites.corner(i, j, k, dim);
        bool filled;
        if (shape.fill == Fill::cell) {
          filled = region.holds_cell(x, sites.edge);
        } else {
          for (int d = 0; d < dim; ++d) x[d] += sites.edge / 2;
          filled = region.holds(turned(x, sites.origin, sites.angle, dim));
        }
        if (filled && visit(i, j, k)) return true;
      }
    }
  return false;
}

/// The cells of a lattice, of which each may hold a particle.
CellGrid grid_of(const Sites& sites, int dim) {
  CellGrid grid{
      .origin = sites.origin, .edge = sites.edge, .dim = dim, .first = sites.first, .last = sites.last};
  if (dim == 2) {
    grid.first = {sites.first[0], 0, sites.first[1]};
    grid.last = {sites.last[0], 1, sites.last[1]};
  }
  return grid;
}

/// The particles of parts of cells, with their volumes.
template <class Visit>
bool any_part(const Shape& shape, const MeshConfig& mesh, int dim, LatticePart part, Visit&& visit) {
  const Sites all(shape, mesh, dim);
  Sites some = all;
  some.cut(part, dim);
  const Facets facets(shape, mesh, dim, all.edge);
  const double cell = std::pow(all.edge, dim);
  return any_cut_particle(facets, grid_of(all, dim), some.first[dim - 1], some.last[dim - 1],
                          [&](const Vec3& x, double volume) { return visit(x, volume * cell); });
}

/// As any_site, with the place and volume of each particle.
template <class Visit>
bool any_particle(const Shape& shape, const MeshConfig& mesh, int dim, LatticePart part, Visit&& visit) {
  if (shape.fill == Fill::cut) return any_part(shape, mesh, dim, part, visit);
  Sites sites(shape, mesh, dim);
  sites.cut(part, dim);
  const int n = sites.particles;
  const double volume = std::pow(sites.edge / n, dim);
  return any_site(shape, mesh, dim, sites, [&](long i, long j, long k) {
    for (int c = 0; c < (dim == 3 ? n : 1); ++c)
      for (int b = 0; b < n; ++b)
        for (int a = 0; a < n; ++a)
          if (visit(sites.particle(i * n + a, j * n + b, k * n + c, dim), volume)) return true;
    return false;
  });
}

/// Shapes cut out of another.
class Holes {
 public:
  Holes(const std::vector<Shape>& shapes, const MeshConfig& mesh, int dim) : up_(dim - 1) {
    for (const Shape& shape : shapes) regions_.emplace_back(shape, dim, k_slack * mesh.spacing);
  }
  bool hold(const Vec3& x) {
    return std::any_of(regions_.begin(), regions_.end(), [&](Region& region) {
      region.enter_row(x[up_], x[up_]);
      return region.holds(x);
    });
  }

 private:
  int up_;
  std::vector<Region> regions_;
};

}  // namespace

std::vector<std::pair<std::string, std::string>> files_of(const std::string& name, const Shape& shape) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& [key, file] :
       {std::pair{"_file", shape.file}, {"_top", shape.top_file}, {"_base", shape.base_file}})
    if (!file.empty()) files.emplace_back("-" + name + key, file);
  for (std::size_t n = 0; n < shape.parts.size(); ++n) {
    const auto more = files_of(shape.part_names[n], shape.parts[n]);
    files.insert(files.end(), more.begin(), more.end());
  }
  return files;
}

std::vector<Shape> cut_out_of(const Config& config, const BodyConfig& body) {
  std::vector<Shape> shapes;
  const int placed = placed_at(config.stage, body.name);
  const auto add = [&](const auto& other) {
    if (placed_at(config.stage, other.name) == placed) shapes.push_back(other.shape);
  };
  for (const int rigid : body.cut_out) add(config.rigids[rigid]);
  for (const int other : body.cut_out_bodies) add(config.bodies[other]);
  return shapes;
}

double Lattice::held_volume() const {
  if (volume.empty()) return static_cast<double>(position.size()) / dim * particle_volume;
  return std::accumulate(volume.begin(), volume.end(), 0.0);
}

PetscErrorCode fill(const Shape& shape, const MeshConfig& mesh, int dim, Lattice& lattice,
                    const std::vector<Shape>& cut_out, LatticePart part) {
  PetscFunctionBeginUser;
  PetscCheck(shape.kind != ShapeKind::particles, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "A list of particles has no lattice");
  lattice = {};
  lattice.dim = dim;
  lattice.spacing = mesh.spacing / shape.particles_per_cell;
  lattice.particle_volume = std::pow(lattice.spacing, dim);
  lattice.shape_volume = shape_volume(shape, mesh, dim);
  auto& position = lattice.position;
  const auto expected =
      static_cast<std::size_t>(1.01 * lattice.shape_volume / lattice.particle_volume / part.of);
  PetscCallCXX(position.reserve(dim * expected));
  Holes holes(cut_out, mesh, dim);
  PetscCallCXX(any_particle(shape, mesh, dim, part, [&](const Vec3& x, double volume) {
    if (holes.hold(x)) {
      ++lattice.cut_out;
      lattice.cut_volume += volume;
      return false;
    }
    position.insert(position.end(), x.begin(), x.begin() + dim);
    if (shape.fill == Fill::cut) lattice.volume.push_back(volume);
    return false;
  }));
  PetscFunctionReturn(PETSC_SUCCESS);
}

double fill_bytes(const Shape& shape, const MeshConfig& mesh, int dim) {
  if (shape.fill != Fill::cut) return 0;
  const Bounds bounds = within(bounds_of(shape, mesh, dim), mesh, dim);
  const double edge = mesh.spacing / shape.particles_per_cell;
  double columns = 1;
  for (int d = 0; d < dim - 1; ++d) columns *= std::max(0.0, bounds.upper[d] - bounds.lower[d]) / edge + 2;
  return columns * k_column_bytes;
}

bool holds_particle(const Shape& shape, const MeshConfig& mesh, int dim, const std::vector<Shape>& cut_out) {
  Holes holes(cut_out, mesh, dim);
  return any_particle(shape, mesh, dim, {}, [&](const Vec3& x, double) { return !holes.hold(x); });
}

}  // namespace mpm
