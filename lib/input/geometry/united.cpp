#include "input/geometry/united.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/region.hpp"

namespace mpm {
namespace {

/// Bounds that two bounds share.
Bounds common(const Bounds& a, const Bounds& b, int dim) {
  Bounds out = a;
  for (int d = 0; d < dim; ++d)
    out.lower[d] = std::max(a.lower[d], b.lower[d]), out.upper[d] = std::min(a.upper[d], b.upper[d]);
  return out;
}

/// Tests of the parts of a union for points.
class Parts {
 public:
  Parts(const std::vector<Shape>& parts, int dim, double slack) : up_(dim - 1) {
    for (const Shape& part : parts) regions_.emplace_back(part, dim, slack);
  }
  bool holds(std::size_t n, const Vec3& x) {
    regions_[n].enter_row(x[up_], x[up_]);
    return regions_[n].holds(x);
  }

 private:
  int up_;
  std::vector<Region> regions_;
};

/// Sums over the cells of a lattice whose middles are in a solid. The numbers have no round-off: twice the
/// coordinates of the middles, in cells.
struct CellSums {
  double count = 0;
  std::array<double, 3> first{};
  std::array<double, 6> second{};  // products xx, yy, zz, xy, yz, zx

  void add(const std::array<int, 3>& cell) {
    ++count;
    for (int d = 0; d < 3; ++d) {
      const double x = 2 * cell[d] + 1, next = 2 * cell[(d + 1) % 3] + 1;
      first[d] += x, second[d] += x * x, second[3 + d] += x * next;
    }
  }
  /// lower [m], edge [m]: of the lattice, from its lower corner.
  MassProperties solid(const Vec3& lower, const Vec3& edge, int dim) const {
    MassProperties of;
    of.volume = count * edge[0] * edge[1] * (dim == 3 ? edge[2] : 1);
    std::array<double, 6> spread{};  // mean products of coordinates from the centre [m2]
    for (int d = 0; d < dim; ++d) {
      of.centre[d] = lower[d] + edge[d] * first[d] / count / 2;
      const int next = (d + 1) % 3;
      const double one =
          1.0 / 3;  // mean square of a cell about its middle, in quarters of the square of its edge
      spread[d] = edge[d] * edge[d] / 4 * (second[d] / count - first[d] / count * first[d] / count + one);
      if (next < dim)
        spread[3 + d] =
            edge[d] * edge[next] / 4 * (second[3 + d] / count - first[d] / count * first[next] / count);
    }
    if (dim == 3)
      spread[5] = edge[2] * edge[0] / 4 * (second[5] / count - first[2] / count * first[0] / count);
    for (int d = 0; d < 3; ++d) {
      if (dim == 3 || d == 2) of.inertia[d] = of.volume * (spread[(d + 1) % 3] + spread[(d + 2) % 3]);
      if (dim == 3) of.inertia[3 + d] = -of.volume * spread[3 + d];
    }
    return of;
  }
};

/// Solids that two parts share in a box and that no part before these two has, by the cells of a lattice.
std::vector<MassProperties> shared_solids(const Shape& shape, const Bounds& box, int dim) {
  const int count = dim == 2 ? 500 : 60;  // in each direction
  Parts parts(shape.parts, dim, 0);
  std::vector<Bounds> bounds;
  for (const Shape& part : shape.parts) bounds.push_back(bounds_of(part, {}, dim));
  std::vector<MassProperties> solids;
  for (std::size_t n = 1; n < bounds.size(); ++n)
    for (std::size_t m = 0; m < n; ++m) {
      const Bounds both = common(common(bounds[m], bounds[n], dim), box, dim);
      Vec3 edge{};
      for (int d = 0; d < dim; ++d) edge[d] = (both.upper[d] - both.lower[d]) / count;
      if (!(edge[0] > 0 && edge[1] > 0 && (dim == 2 || edge[2] > 0))) continue;
      CellSums sums;
      std::array<int, 3> at{};
      // The vertical coordinate changes last: a row of a polygon has its edges.
      for (at[dim - 1] = 0; at[dim - 1] < count; ++at[dim - 1])
        for (int j = 0; j < (dim == 3 ? count : 1); ++j)
          for (at[0] = 0; at[0] < count; ++at[0]) {
            if (dim == 3) at[1] = j;
            Vec3 x{};
            for (int d = 0; d < dim; ++d) x[d] = both.lower[d] + (at[d] + 0.5) * edge[d];
            bool shared = parts.holds(n, x) && parts.holds(m, x);
            for (std::size_t before = 0; before < m && shared; ++before) shared = !parts.holds(before, x);
            if (shared) sums.add(at);
          }
      if (sums.count > 0) solids.push_back(sums.solid(both.lower, edge, dim));
    }
  return solids;
}

/// Sum of solids, about a point.
struct Sum {
  Vec3 about;
  int dim;
  MassProperties of{};  // its centre is the first moment

  void add(double sign, const MassProperties& solid) {
    const double volume = solid.volume;
    Vec3 r{};
    for (int d = 0; d < dim; ++d) r[d] = solid.centre[d] - about[d];
    const double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    of.volume += sign * volume;
    for (int d = 0; d < 3; ++d) {
      of.centre[d] += sign * volume * r[d];
      of.inertia[d] += sign * (solid.inertia[d] + (dim == 3 || d == 2 ? volume * (square - r[d] * r[d]) : 0));
      of.inertia[3 + d] += sign * (solid.inertia[3 + d] - (dim == 3 ? volume * r[d] * r[(d + 1) % 3] : 0));
    }
  }
  MassProperties about_centre() const {
    MassProperties out = of;
    Vec3 r{};
    for (int d = 0; d < dim; ++d) r[d] = of.centre[d] / of.volume, out.centre[d] = about[d] + r[d];
    const double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    for (int d = 0; d < 3; ++d) {
      if (dim == 3 || d == 2) out.inertia[d] -= of.volume * (square - r[d] * r[d]);
      if (dim == 3) out.inertia[3 + d] += of.volume * r[d] * r[(d + 1) % 3];
    }
    return out;
  }
};

/// End of a box or a cylinder, which may be moved outwards.
struct End {
  int axis;
  bool upper;
};

/// Places of an end of a shape that is longer by a length there [m].
std::vector<Vec3> places_of(const Shape& shape, const End& end, double by, double apart, int dim) {
  std::vector<Vec3> out;
  if (shape.kind == ShapeKind::cylinder) {
    constexpr int k_rim = 32;
    const double z = shape.centre[2] + (end.upper ? shape.height + by : -by);
    out.push_back({shape.centre[0], shape.centre[1], z});
    for (int n = 0; n < k_rim; ++n)
      for (const double r : {0.5 * shape.radius, shape.radius}) {
        const double angle = 2 * M_PI * n / k_rim;
        out.push_back({shape.centre[0] + r * std::cos(angle), shape.centre[1] + r * std::sin(angle), z});
      }
    return out;
  }
  constexpr int k_most = 32;
  int count[3] = {1, 1, 1};
  Vec3 step{};
  for (int d = 0; d < dim; ++d) {
    if (d == end.axis) continue;
    const double length = shape.upper[d] - shape.lower[d];
    count[d] = 1 + std::clamp(static_cast<int>(std::ceil(length / apart)), 1, k_most);
    step[d] = length / (count[d] - 1);
  }
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        Vec3 x{shape.lower[0] + i * step[0], shape.lower[1] + j * step[1], shape.lower[2] + k * step[2]};
        x[end.axis] = end.upper ? shape.upper[end.axis] + by : shape.lower[end.axis] - by;
        out.push_back(turned(x, shape.lower, shape.angle, dim));
      }
  return out;
}

void move_end(Shape& shape, const End& end, double by, int dim) {
  if (shape.kind == ShapeKind::cylinder) {
    shape.height += by;
    if (!end.upper) shape.centre[2] -= by;
    return;
  }
  if (end.upper) {
    shape.upper[end.axis] += by;
    return;
  }
  Vec3 corner = shape.lower;  // about which the box is turned
  corner[end.axis] -= by;
  corner = turned(corner, shape.lower, shape.angle, dim);
  for (int d = 0; d < dim; ++d) {
    const double length = shape.upper[d] - shape.lower[d] + (d == end.axis ? by : 0);
    shape.lower[d] = corner[d], shape.upper[d] = corner[d] + length;
  }
}

std::vector<End> ends_to_grow(const Shape& shape, int dim) {
  std::vector<End> ends;
  for (int d = 0; d < dim && shape.kind == ShapeKind::box; ++d)
    for (const bool upper : {false, true}) ends.push_back({d, upper});
  if (shape.kind != ShapeKind::cylinder) return ends;
  ends.push_back({2, true});
  if (shape.tip_height == 0) ends.push_back({2, false});
  return ends;
}

}  // namespace

double united_volume(const Shape& shape, const MeshConfig& mesh, int dim) {
  double volume = 0;
  for (const Shape& part : shape.parts) volume += shape_volume(part, mesh, dim);
  for (const MassProperties& solid : shared_solids(shape, {mesh.lower, mesh.upper}, dim))
    volume -= solid.volume;
  return volume;
}

MassProperties united_properties(const Shape& shape, int dim) {
  const Bounds bounds = united_bounds(shape, {}, dim);
  Sum sum{bounds.lower, dim};
  for (const Shape& part : shape.parts) sum.add(1, mass_properties(part, dim).value());
  for (const MassProperties& solid : shared_solids(shape, bounds, dim)) sum.add(-1, solid);
  return sum.about_centre();
}

Bounds united_bounds(const Shape& shape, const MeshConfig& mesh, int dim) {
  Bounds bounds = bounds_of(shape.parts[0], mesh, dim);
  for (const Shape& part : shape.parts) {
    const Bounds of = bounds_of(part, mesh, dim);
    for (int d = 0; d < dim; ++d) {
      bounds.lower[d] = std::min(bounds.lower[d], of.lower[d]);
      bounds.upper[d] = std::max(bounds.upper[d], of.upper[d]);
    }
  }
  return bounds;
}

std::vector<Shape> grown_parts(const Shape& shape, const MeshConfig& mesh, int dim) {
  constexpr int k_steps = 8;
  constexpr double k_step = 0.25, k_apart = 0.5, k_slack = 1e-6;  // cells
  Parts all(shape.parts, dim, k_slack * mesh.spacing);
  std::vector<Shape> grown = shape.parts;
  for (std::size_t n = 0; n < grown.size(); ++n)
    for (const End& end : ends_to_grow(grown[n], dim)) {
      const auto is_within = [&](int step) {
        const auto places =
            places_of(shape.parts[n], end, step * k_step * mesh.spacing, k_apart * mesh.spacing, dim);
        return std::all_of(places.begin(), places.end(), [&](const Vec3& x) {
          for (std::size_t m = 0; m < grown.size(); ++m)
            if (m != n && all.holds(m, x)) return true;
          return false;
        });
      };
      int steps = 0;
      while (steps <= k_steps && is_within(steps)) ++steps;
      if (steps > 1) move_end(grown[n], end, (steps - 1) * k_step * mesh.spacing, dim);
    }
  return grown;
}

}  // namespace mpm
