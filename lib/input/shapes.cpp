#include "input/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "input/polygon.hpp"

namespace mpm {
namespace {

constexpr double k_slack = 1e-9;  // of the mesh spacing

/// What is inside a shape, asked row by row (of constant y, z).
class Region {
 public:
  Region(const Shape& shape, int dim, double slack) : shape_(shape), dim_(dim), slack_(slack) {}

  /// Prepares for points and cells with low <= y <= high.
  void enter_row(double low, double high) {
    if (shape_.kind == ShapeKind::polygon) edges_ = edges_in_row(shape_.polygon, low - slack_, high + slack_);
  }
  bool holds(const Vec3& x) const {
    if (shape_.kind == ShapeKind::polygon) return is_inside(edges_, {x[0], x[1]}, slack_);
    double square = 0;  // of the distance to the centre of the disc or to the box made smaller by its fillet
    for (int d = 0; d < dim_; ++d) {
      const double out = shape_.kind == ShapeKind::disc
                             ? x[d] - shape_.centre[d]
                             : std::max({shape_.lower[d] + shape_.fillet - x[d],
                                         x[d] - shape_.upper[d] + shape_.fillet, 0.0});
      square += out * out;
    }
    const double reach = (shape_.kind == ShapeKind::disc ? shape_.radius : shape_.fillet) + slack_;
    return square <= reach * reach;
  }
  /// Whether the whole cell is inside. Its corners suffice for shapes that are convex.
  bool holds_cell(const Vec3& corner, double edge) const {
    for (int k = 0; k < 1 << dim_; ++k) {
      Vec3 x = corner;
      for (int d = 0; d < dim_; ++d) x[d] += (k >> d & 1) * edge;
      if (!holds(x)) return false;
    }
    const Point2 lower{corner[0], corner[1]}, upper{corner[0] + edge, corner[1] + edge};
    return std::none_of(edges_.begin(), edges_.end(),
                        [&](const Edge& side) { return enters_square(side, lower, upper, slack_); });
  }

 private:
  const Shape& shape_;
  int dim_;
  double slack_;
  std::vector<Edge> edges_;  // polygon: those of the row
};

/// A grid of equal squares (cubes) round a shape: particles' own for Fill::centre, the mesh's cells for
/// Fill::cell.
struct Sites {
  Vec3 origin{};
  double edge = 0;                      // m
  int particles = 1;                    // in each direction of a site
  std::array<long, 3> first{}, last{};  // first <= k < last in each direction

  Sites(const Shape& shape, const MeshConfig& mesh, int dim) {
    const bool cells = shape.fill == Fill::cell;
    origin = cells || shape.kind != ShapeKind::box ? mesh.lower : shape.lower;
    edge = cells ? mesh.spacing : mesh.spacing / shape.particles_per_cell;
    particles = cells ? shape.particles_per_cell : 1;
    last[2] = 1;
    const Bounds bounds = bounds_of(shape, dim);
    for (int d = 0; d < dim; ++d) {
      first[d] = std::lround(std::floor((bounds.lower[d] - origin[d]) / edge - 0.5));
      last[d] = std::lround(std::ceil((bounds.upper[d] - origin[d]) / edge + 0.5));
    }
  }
  Vec3 corner(long i, long j, long k, int dim) const {
    return {origin[0] + i * edge, origin[1] + j * edge, dim == 3 ? origin[2] + k * edge : 0};
  }
};

/// Calls visit(i, j, k) for each filled site, x fastest, until it returns true; returns whether it did.
template <class Visit>
bool any_site(const Shape& shape, const MeshConfig& mesh, int dim, const Sites& sites, Visit&& visit) {
  Region region(shape, dim, k_slack * mesh.spacing);
  for (long k = sites.first[2]; k < sites.last[2]; ++k)
    for (long j = sites.first[1]; j < sites.last[1]; ++j) {
      const double y = sites.corner(0, j, k, dim)[1];
      region.enter_row(y, y + sites.edge);
      for (long i = sites.first[0]; i < sites.last[0]; ++i) {
        Vec3 x = sites.corner(i, j, k, dim);
        bool filled;
        if (shape.fill == Fill::cell) {
          filled = region.holds_cell(x, sites.edge);
        } else {
          for (int d = 0; d < dim; ++d) x[d] += sites.edge / 2;
          filled = region.holds(x);
        }
        if (filled && visit(i, j, k)) return true;
      }
    }
  return false;
}

}  // namespace

PetscErrorCode fill(const Shape& shape, const MeshConfig& mesh, int dim, Lattice& lattice) {
  PetscFunctionBeginUser;
  PetscCheck(shape.kind != ShapeKind::polygon || dim == 2, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "A polygon has no volume in 3D");
  const Sites sites(shape, mesh, dim);
  const int n = sites.particles;
  lattice = {};
  lattice.spacing = mesh.spacing / shape.particles_per_cell;
  lattice.particle_volume = std::pow(lattice.spacing, dim);
  lattice.shape_volume = shape_volume(shape, dim);
  auto& position = lattice.position;
  const auto expected = static_cast<std::size_t>(1.01 * lattice.shape_volume / lattice.particle_volume);
  PetscCallCXX(position.reserve(dim * expected));
  PetscCallCXX(any_site(shape, mesh, dim, sites, [&](long i, long j, long k) {
    for (int c = 0; c < (dim == 3 ? n : 1); ++c)
      for (int b = 0; b < n; ++b)
        for (int a = 0; a < n; ++a) {
          position.push_back(sites.origin[0] + (i * n + a + 0.5) * lattice.spacing);
          position.push_back(sites.origin[1] + (j * n + b + 0.5) * lattice.spacing);
          if (dim == 3) position.push_back(sites.origin[2] + (k * n + c + 0.5) * lattice.spacing);
        }
    return false;
  }));
  PetscFunctionReturn(PETSC_SUCCESS);
}

bool holds_particle(const Shape& shape, const MeshConfig& mesh, int dim) {
  return any_site(shape, mesh, dim, Sites(shape, mesh, dim), [](long, long, long) { return true; });
}

double shape_volume(const Shape& shape, int dim) {
  constexpr double k_pi = std::numbers::pi;
  const double r = shape.kind == ShapeKind::disc ? shape.radius : shape.fillet;
  if (shape.kind == ShapeKind::polygon) return area_of(shape.polygon);
  if (shape.kind == ShapeKind::disc) return dim == 2 ? k_pi * r * r : 4 * k_pi / 3 * r * r * r;
  // the box made smaller by its fillet, and all within the fillet of it (Steiner's formula)
  Vec3 e{};
  for (int d = 0; d < dim; ++d) e[d] = std::max(0.0, shape.upper[d] - shape.lower[d] - 2 * r);
  if (dim == 2) return e[0] * e[1] + 2 * r * (e[0] + e[1]) + k_pi * r * r;
  return e[0] * e[1] * e[2] + 2 * r * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]) +
         k_pi * r * r * (e[0] + e[1] + e[2]) + 4 * k_pi / 3 * r * r * r;
}

Bounds bounds_of(const Shape& shape, int dim) {
  Bounds bounds;
  for (int d = 0; d < dim; ++d) {
    if (shape.kind == ShapeKind::box) {
      bounds.lower[d] = shape.lower[d], bounds.upper[d] = shape.upper[d];
    } else if (shape.kind == ShapeKind::disc) {
      bounds.lower[d] = shape.centre[d] - shape.radius, bounds.upper[d] = shape.centre[d] + shape.radius;
    } else if (d < 2) {
      const auto [low, high] =
          std::minmax_element(shape.polygon.begin(), shape.polygon.end(),
                              [d](const Point2& a, const Point2& b) { return a[d] < b[d]; });
      bounds.lower[d] = (*low)[d], bounds.upper[d] = (*high)[d];
    }
  }
  return bounds;
}

}  // namespace mpm
