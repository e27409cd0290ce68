#pragma once
// Plane polygons: given by their vertices in order, either way round, closed by the edge from the last to the
// first.

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace mpm {

using Point2 = std::array<double, 2>;  // m
using Polygon = std::vector<Point2>;
struct Edge {
  Point2 from, to;
};

/// Enclosed area [m2] (shoelace formula).
double area_of(const Polygon& polygon);
/// Positive where the polygon goes round anticlockwise.
double signed_area_of(const Polygon& polygon);

/// Edge k of a polygon, from vertex k to the next.
Edge edge_of(const Polygon& polygon, std::size_t k);

/// Whether a point is inside or within `slack` [m] of an edge; edges are those of a row that holds the point.
bool is_inside(const std::vector<Edge>& edges, const Point2& point, double slack);

/// Whether an edge passes through the inside of the square [lower, upper] made smaller by `slack` [m].
bool enters_square(const Edge& edge, const Point2& lower, const Point2& upper, double slack);

/// Whether edges i < j, counted from 0, cross or touch other than as neighbours do (also neighbours that fold
/// back), with a slack of 1e-12 of their lengths.
bool cross(const Polygon& polygon, int i, int j);

/// The first two edges that cross(), counted from 0: the least i, and its least j. In n log n where the
/// polygon's edges are not nearly all at one place.
std::optional<std::pair<int, int>> first_crossing(const Polygon& polygon);

}  // namespace mpm
