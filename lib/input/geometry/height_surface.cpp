#include "input/geometry/height_surface.hpp"

#include <algorithm>
#include <cmath>

#include "common/text.hpp"

namespace mpm {
namespace {

/// The number of the line at or before x; -1 before the first one. The lines of a raster are equally far
/// apart, but for the outermost ones: a guess finds them without a search.
long line_before(const std::vector<double>& lines, double x) {
  if (lines.size() > 4) {
    const double guess = 1 + (x - lines[1]) / (lines[2] - lines[1]);
    if (guess > 0 && guess < static_cast<double>(lines.size() - 1))
      for (long k = static_cast<long>(guess) - 1; k <= static_cast<long>(guess) + 1; ++k)
        if (k >= 0 && k + 1 < static_cast<long>(lines.size()) && lines[k] <= x && x < lines[k + 1]) return k;
  }
  return std::upper_bound(lines.begin(), lines.end(), x) - lines.begin() - 1;
}

/// A cell of the lines and how far into it a coordinate is, 0 to 1; beyond the lines at its end.
struct Within {
  std::size_t cell = 0;
  double part = 0;

  Within(const std::vector<double>& lines, double x) {
    if (lines.size() < 2) return;
    cell =
        static_cast<std::size_t>(std::clamp(line_before(lines, x), 0L, static_cast<long>(lines.size()) - 2));
    part = std::clamp((x - lines[cell]) / (lines[cell + 1] - lines[cell]), 0.0, 1.0);
  }
};

/// From low to high, with the lines between.
std::vector<double> stations(const std::vector<double>& lines, double low, double high) {
  std::vector<double> at{low};
  for (const double line : lines)
    if (line > low && line < high) at.push_back(line);
  if (high > low) at.push_back(high);
  return at;
}

/// The mesh as seen from above; in 2D y is 0.
struct Plan {
  Vec3 lower, upper;
  Plan(const MeshConfig& mesh, int dim) : lower(mesh.lower), upper(mesh.upper) {
    if (dim == 2) lower[1] = upper[1] = 0;
  }
};

/// Where a side of the mesh cuts through cells, the diagonals of these.
template <class Visit>
void visit_diagonals(const HeightSurface& surface, const Plan& plan, Visit& visit) {
  for (int d = 0; d < 2; ++d) {
    const auto &across = surface.lines(d), &along = surface.lines(1 - d);
    const auto [first, last] = surface.lines_around(1 - d, plan.lower[1 - d], plan.upper[1 - d]);
    for (const double side : {plan.lower[d], plan.upper[d]}) {
      const double part = Within(across, side).part;
      for (std::size_t k = first; k < last; ++k)
        for (const double share : {part, 1 - part}) {
          const double other = along[k] + share * (along[k + 1] - along[k]);
          if (other >= plan.lower[1 - d] && other <= plan.upper[1 - d])
            d == 0 ? visit(side, other) : visit(other, side);
        }
    }
  }
}

/// Calls visit(x, y) for all places in the mesh between which a surface is plane.
template <class Visit>
void visit_nodes(const HeightSurface& surface, const Plan& plan, Visit&& visit) {
  const auto x = stations(surface.lines(0), plan.lower[0], plan.upper[0]),
             y = stations(surface.lines(1), plan.lower[1], plan.upper[1]);
  for (const double b : y)
    for (const double a : x) visit(a, b);
  if (surface.lines(1).empty()) return;
  const auto middles = [&plan](const std::vector<double>& lines, int d) {
    std::vector<double> at;
    for (std::size_t k = 0; k + 1 < lines.size(); ++k)
      if (const double m = (lines[k] + lines[k + 1]) / 2; m > plan.lower[d] && m < plan.upper[d])
        at.push_back(m);
    return at;
  };
  const auto u = middles(surface.lines(0), 0), v = middles(surface.lines(1), 1);
  for (const double b : v)
    for (const double a : u) visit(a, b);
  visit_diagonals(surface, plan, visit);
}

std::string place_of(double x, double y, int dim) {
  return dim == 2 ? "x = " + text_of({&x, 1}) : text_of(std::array<double, 2>{x, y});
}

/// Empty where the lines reach from side to side of the mesh.
std::string gap_fault(const HeightSurface& surface, const MeshConfig& mesh, int dim) {
  if (surface.is_level()) return "";
  const double slack = 1e-9 * mesh.spacing;
  const int axes = surface.lines(1).empty() ? 1 : 2;
  for (int d = 0; d < axes; ++d) {
    const auto& lines = surface.lines(d);
    if (lines.front() <= mesh.lower[d] + slack && lines.back() >= mesh.upper[d] - slack) continue;
    const auto range = [](double low, double high) { return formatted("%.10g to %.10g", low, high); };
    return formatted("a surface that covers the mesh, in %c from ", "xy"[d]) +
           range(mesh.lower[d], mesh.upper[d]) + "; it has " + range(lines.front(), lines.back()) +
           (dim == 3 && axes == 1 ? ", the same for all y" : "");
  }
  return "";
}

}  // namespace

HeightSurface::HeightSurface(std::vector<double> x, std::vector<double> y, std::vector<double> heights)
    : x_(std::move(x)), y_(std::move(y)), height_(std::move(heights)) {}

double HeightSurface::at(double x, double y) const {
  if (is_level()) return height_[0];
  const Within u(x_, x), v(y_, y);
  const double a = node(u.cell, v.cell), b = node(u.cell + 1, v.cell);
  if (y_.empty()) return a + u.part * (b - a);
  const double c = node(u.cell, v.cell + 1), d = node(u.cell + 1, v.cell + 1), middle = (a + b + c + d) / 4;
  // In the triangle at the side of p and q, r from 0 at the side to 1/2 in the middle, s along the side.
  const auto triangle = [middle](double p, double q, double r, double s) {
    return p + (q - p) * s + r * (2 * middle - p - q);
  };
  const double s = u.part, t = v.part;
  if (t <= s && t <= 1 - s) return triangle(a, b, t, s);
  if (t >= s && t >= 1 - s) return triangle(c, d, 1 - t, s);
  return s <= t ? triangle(a, c, s, t) : triangle(b, d, 1 - s, t);
}

std::array<std::size_t, 2> HeightSurface::lines_around(int d, double low, double high) const {
  const auto& lines = this->lines(d);
  if (lines.size() < 2) return {0, 0};
  const long end = static_cast<long>(lines.size()) - 1,
             first = std::clamp(line_before(lines, low), 0L, end - 1);
  const auto above = std::lower_bound(lines.begin(), lines.end(), high) - lines.begin();
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(std::clamp(above, first + 1, end))};
}

std::array<double, 2> heights_of(const HeightSurface& surface, const MeshConfig& mesh, int dim) {
  constexpr double k_far = 1e300;
  std::array<double, 2> range{k_far, -k_far};
  visit_nodes(surface, Plan(mesh, dim), [&](double x, double y) {
    const double height = surface.at(x, y);
    range = {std::min(range[0], height), std::max(range[1], height)};
  });
  return range;
}

LayerBounds bounds_between(const HeightSurface& top, const HeightSurface& base, const MeshConfig& mesh,
                           int dim) {
  const int up = dim - 1;
  LayerBounds whole{mesh.lower, mesh.upper};
  whole.lower[up] = heights_of(base, mesh, dim)[0], whole.upper[up] = heights_of(top, mesh, dim)[1];
  const auto &x = top.lines(0), &y = top.lines(1);
  if (dim == 2 || y.empty() || x != base.lines(0) || y != base.lines(1)) return whole;
  constexpr double k_far = 1e300;
  LayerBounds part{{k_far, k_far, k_far}, {-k_far, -k_far, -k_far}};
  const auto add = [&part](int d, double at) {
    part.lower[d] = std::min(part.lower[d], at), part.upper[d] = std::max(part.upper[d], at);
  };
  const auto columns = top.lines_around(0, mesh.lower[0], mesh.upper[0]),
             rows = top.lines_around(1, mesh.lower[1], mesh.upper[1]);
  for (std::size_t j = rows[0]; j <= rows[1]; ++j)
    for (std::size_t i = columns[0]; i <= columns[1]; ++i) {
      if (!(top.node(i, j) - base.node(i, j) > 1e-9 * mesh.spacing)) continue;
      for (std::size_t l = std::max(j, rows[0] + 1) - 1; l <= std::min(j + 1, rows[1]); ++l)
        for (std::size_t k = std::max(i, columns[0] + 1) - 1; k <= std::min(i + 1, columns[1]); ++k)
          add(0, x[k]), add(1, y[l]), add(2, top.node(k, l)), add(2, base.node(k, l));
    }
  if (part.upper[0] < part.lower[0]) return whole;  // nowhere apart
  for (int d = 0; d < 3; ++d) {
    part.lower[d] = std::max(part.lower[d], whole.lower[d]);
    part.upper[d] = std::min(part.upper[d], whole.upper[d]);
  }
  return part;
}

std::string fault_of(const HeightSurface& surface, const MeshConfig& mesh, int dim) {
  if (const std::string gap = gap_fault(surface, mesh, dim); !gap.empty()) return gap;
  const int up = dim - 1;
  const double low = mesh.lower[up], high = mesh.upper[up], slack = 1e-9 * mesh.spacing;
  std::string fault;
  visit_nodes(surface, Plan(mesh, dim), [&](double x, double y) {
    if (!fault.empty()) return;
    const double height = surface.at(x, y);
    if (std::isnan(height))
      fault = "a surface without no-data in the mesh; there is some at " + place_of(x, y, dim);
    else if (height < low - slack || height > high + slack)
      fault = formatted("a surface in the mesh, from %.10g to %.10g; it is at %.10g at ", low, high, height) +
              place_of(x, y, dim);
  });
  return fault;
}

std::optional<Crossing> crossing_of(const HeightSurface& top, const HeightSurface& base,
                                    const MeshConfig& mesh, int dim) {
  const Plan plan(mesh, dim);
  Crossing worst{0, 0, 1e-9 * mesh.spacing};
  bool found = false;
  for (const HeightSurface* nodes : {&top, &base})
    visit_nodes(*nodes, plan, [&](double x, double y) {
      const double above = base.at(x, y) - top.at(x, y);
      if (above > worst.height) worst = {x, y, above}, found = true;
    });
  return found ? std::optional(worst) : std::nullopt;
}

}  // namespace mpm
