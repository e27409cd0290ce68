#include "input/geometry/triangle_surface.hpp"

#include <algorithm>
#include <numeric>

#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

double triple_product(const Vec3& a, const Vec3& b, const Vec3& c) {
  return inner_product(a, outer_product(b, c));
}

/// The number of each corner's vertex, and the vertices.
std::vector<int> join_corners(const std::vector<Vec3>& corners, std::vector<Vec3>& vertices) {
  std::vector<int> order(corners.size()), number(corners.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return corners[a] < corners[b]; });
  for (const int k : order) {
    if (vertices.empty() || vertices.back() != corners[k]) vertices.push_back(corners[k]);
    number[k] = static_cast<int>(vertices.size()) - 1;
  }
  return number;
}

/// Side of the edge from a to b that a point is on, seen from above: 1 left, -1 right. The same edge the
/// other way round gives the other side, to the bit.
int side_of(const Vec3& a, const Vec3& b, const Vec3& x) {
  const double turn = (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]);
  if (turn != 0) return turn > 0 ? 1 : -1;
  if (b[1] != a[1]) return b[1] < a[1] ? 1 : -1;
  return b[0] > a[0] ? 1 : -1;
}

}  // namespace

TriangleSurface::TriangleSurface(const std::vector<Vec3>& corners) {
  const std::vector<int> number = join_corners(corners, vertices_);
  std::vector<Box> boxes;
  for (std::size_t k = 0; k + 2 < number.size(); k += 3) {
    const std::array<int, 3> v{number[k], number[k + 1], number[k + 2]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    triangles_.push_back(v);
    for (const int c : v) (v[0] == c ? boxes.emplace_back() : boxes.back()).add(vertices_[c]);
    bounds_.add(boxes.back());
  }
  tree_ = BoxTree(std::move(boxes));
  bins_ = PlanBins(vertices_, triangles_, bounds_);
  const Vec3 origin = vertices_.empty() ? Vec3{} : vertices_[0];
  for (const auto& v : triangles_) {
    volume_ += triple_product(difference(vertices_[v[0]], origin), difference(vertices_[v[1]], origin),
                              difference(vertices_[v[2]], origin)) /
               6;
    area_ += length_of(outer_product(difference(vertices_[v[1]], vertices_[v[0]]),
                                     difference(vertices_[v[2]], vertices_[v[0]]))) /
             2;
  }
}

bool TriangleSurface::holds(const Vec3& x, double slack) const {
  int winding = 0;
  Box above{x, x};
  above.lower[2] -= slack, above.upper[2] = Box::k_none;
  bins_.visit_at(x[0], x[1], [&](int k) {
    if (!tree_.boxes()[k].meets(above)) return;
    const auto& v = triangles_[k];
    int side[3];
    for (int c = 0; c < 3; ++c) {
      const int from = v[c], to = v[(c + 1) % 3];
      side[c] = from < to ? side_of(vertices_[from], vertices_[to], x)
                          : -side_of(vertices_[to], vertices_[from], x);
    }
    if (side[0] != side[1] || side[1] != side[2]) return;
    const Vec3 a = difference(vertices_[v[1]], vertices_[v[0]]),
               b = difference(vertices_[v[2]], vertices_[v[0]]), r = difference(x, vertices_[v[0]]);
    const double normal = a[0] * b[1] - a[1] * b[0];  // its vertical component
    const double height = vertices_[v[0]][2] +
                          (r[0] * (a[2] * b[1] - a[1] * b[2]) + r[1] * (a[0] * b[2] - a[2] * b[0])) / normal;
    if (height > x[2] + (side[0] > 0 ? -slack : slack)) winding += side[0];
  });
  return winding > 0;
}

}  // namespace mpm
