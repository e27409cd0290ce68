// Whether a surface of triangles is closed, faces outwards and does not cross itself.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/text.hpp"
#include "input/geometry/triangle_surface.hpp"
#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

/// An edge by its vertices, the lower number first, and whether a triangle goes along it that way.
struct EdgeUse {
  int low, high;
  bool forward;
  bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
  bool operator<(const EdgeUse& other) const {
    return low != other.low     ? low < other.low
           : high != other.high ? high < other.high
                                : forward < other.forward;
  }
};

/// Every edge must be one of two triangles, which go along it in opposite directions.
std::string edge_fault(const TriangleSurface& surface) {
  std::vector<EdgeUse> uses;
  for (int k = 0; k < surface.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      const int a = surface.triangle(k)[c], b = surface.triangle(k)[(c + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  std::sort(uses.begin(), uses.end());
  long open = 0, shared = 0, turned = 0;
  int at = -1;
  for (std::size_t from = 0, to = 0; from < uses.size(); from = to) {
    while (to < uses.size() && uses[to].same_edge(uses[from])) ++to;
    const bool pair = to - from == 2, sound = pair && uses[from].forward != uses[from + 1].forward;
    if (!sound && at < 0) at = uses[from].low;
    open += to - from == 1, shared += to - from > 2, turned += pair && !sound;
  }
  const std::string place = at < 0 ? "" : ", the first at " + text_of(surface.vertex(at), 3);
  if (open > 0) return formatted("a closed surface; %ld of its edges are open", open) + place;
  if (shared > 0)
    return formatted("a surface whose edges are each of two triangles; %ld are of more", shared) + place;
  if (turned > 0)
    return formatted("triangles that all face outwards; at %ld edges one of the two faces inwards", turned) +
           place;
  return "";
}

/// Six times the volume of the tetrahedron p a b c.
double six_volumes(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  return inner_product(difference(a, p), outer_product(difference(b, p), difference(c, p)));
}

using Corners = std::array<Vec3, 3>;

/// Whether the segment from p to q goes through a triangle or its edge, from one side of its plane to the
/// other by more than round-off.
bool pierces(const Vec3& p, const Vec3& q, const Corners& t, double slack) {
  const double from = six_volumes(p, t[0], t[1], t[2]), to = six_volumes(q, t[0], t[1], t[2]);
  if (!((from > slack && to < -slack) || (from < -slack && to > slack))) return false;
  double least = 1, most = -1;  // of the volumes with the edges, over the slack
  for (int c = 0; c < 3; ++c) {
    const double side = six_volumes(p, q, t[c], t[(c + 1) % 3]) / slack;
    least = c == 0 ? side : std::min(least, side), most = c == 0 ? side : std::max(most, side);
  }
  return least >= -1 || most <= 1;
}

/// Whether two triangles cross: of two that share a vertex only the edges opposite to it can; two that share
/// an edge do if one is folded back on the other.
bool cross(const TriangleSurface& surface, int i, int j) {
  const auto &a = surface.triangle(i), &b = surface.triangle(j);
  Corners x, y;
  for (int c = 0; c < 3; ++c) x[c] = surface.corner(i, c), y[c] = surface.corner(j, c);
  int in_a[3], in_b[3], shared = 0;
  for (int c = 0; c < 3; ++c)
    for (int d = 0; d < 3; ++d)
      if (a[c] == b[d] && shared < 3) in_a[shared] = c, in_b[shared] = d, ++shared;
  if (shared == 3) return true;
  if (shared == 2) {
    constexpr double k_flat = 1e-12;
    const Vec3 n = outer_product(difference(x[1], x[0]), difference(x[2], x[0])),
               m = outer_product(difference(y[1], y[0]), difference(y[2], y[0]));
    return inner_product(n, m) < 0 &&
           inner_product(n, m) <= -(1 - k_flat) * std::sqrt(inner_product(n, n) * inner_product(m, m));
  }
  double extent = 0;
  for (int d = 0; d < 3; ++d) {
    const auto [low, high] = std::minmax({x[0][d], x[1][d], x[2][d], y[0][d], y[1][d], y[2][d]});
    extent = std::max(extent, high - low);
  }
  const double slack = 1e-12 * extent * extent * extent;
  for (int c = 0; c < 3; ++c) {
    const int next = (c + 1) % 3;
    if ((shared == 0 || (in_a[0] != c && in_a[0] != next)) && pierces(x[c], x[next], y, slack)) return true;
    if ((shared == 0 || (in_b[0] != c && in_b[0] != next)) && pierces(y[c], y[next], x, slack)) return true;
  }
  return false;
}

std::string crossing_fault(const TriangleSurface& surface) {
  int i = 0, with = -1;
  for (; i < surface.size() && with < 0; ++i)
    surface.tree().any_near(surface.tree().boxes()[i], [&](int j) {
      if (j > i && cross(surface, i, j)) with = j;
      return with >= 0;
    });
  if (with < 0) return "";
  return formatted("a surface that neither crosses nor touches itself; triangles %d and %d do, near ", i,
                   with + 1) +
         text_of(surface.corner(i - 1, 0), 3);
}

}  // namespace

std::string fault_of(const TriangleSurface& surface) {
  if (surface.size() == 0) return "a surface that has triangles";
  if (const std::string fault = edge_fault(surface); !fault.empty()) return fault;
  if (surface.volume() < 0)
    return "triangles that face outwards, anticlockwise as seen from there; these face inwards: their volume "
           "is " +
           formatted("%.6g m3", surface.volume());
  if (surface.volume() == 0) return "a surface that encloses a volume";
  return crossing_fault(surface);
}

}  // namespace mpm
