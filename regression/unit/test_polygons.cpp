// Polygons that cross or touch themselves, and the tree over their edges.

#include <algorithm>
#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "input/geometry/edge_tree.hpp"
#include "input/geometry/polygon.hpp"

using namespace mpm;

namespace {

using Dice = std::mt19937_64;
double uniform(Dice& dice, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(dice);
}

/// Result of first_crossing, by a test of every pair of edges.
std::optional<std::pair<int, int>> first_of_all_pairs(const Polygon& polygon) {
  const int count = static_cast<int>(polygon.size());
  for (int i = 0; i < count; ++i)
    if (polygon[i] == polygon[(i + 1) % count]) return std::pair(i, (i + 1) % count);
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j)
      if (cross(polygon, i, j)) return std::pair(i, j);
  return std::nullopt;
}

Polygon turned_by(Polygon polygon, double angle, double scale, Point2 to) {
  for (Point2& x : polygon)
    x = {to[0] + scale * (std::cos(angle) * x[0] - std::sin(angle) * x[1]),
         to[1] + scale * (std::sin(angle) * x[0] + std::cos(angle) * x[1])};
  return polygon;
}

/// Vertices at random places of a coarse grid, so that many touch.
Polygon scattered(Dice& dice, int count) {
  Polygon polygon;
  for (int k = 0; k < count; ++k)
    polygon.push_back({std::floor(uniform(dice, 0, 9)), std::floor(uniform(dice, 0, 9))});
  return polygon;
}

/// A star, which does not cross itself.
Polygon star(Dice& dice, int count) {
  Polygon polygon;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count, r = uniform(dice, 0.2, 1);
    polygon.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return polygon;
}

/// A star of which some vertices are moved to others, or onto the middle of an edge, or next to it.
Polygon spoilt(Dice& dice, int count) {
  Polygon polygon = star(dice, count);
  for (int n = 0; n < 2; ++n) {
    const int a = static_cast<int>(uniform(dice, 0, count)), b = static_cast<int>(uniform(dice, 0, count));
    const Point2 p = polygon[b], q = polygon[(b + 1) % count];
    const double share = uniform(dice, 0, 1), beside = std::pow(10, uniform(dice, -16, -8));
    polygon[a] = {p[0] + share * (q[0] - p[0]) + beside, p[1] + share * (q[1] - p[1])};
  }
  return polygon;
}

/// Teeth of length 1 side by side.
Polygon comb(int teeth) {
  Polygon polygon;
  for (int k = 0; k < teeth; ++k)
    for (const auto& [x, y] : {Point2{0, 0}, Point2{0.3, 1}, Point2{0.6, 1}, Point2{0.9, 0}})
      polygon.push_back({(k + x) / teeth, y});
  polygon.push_back({1, -0.1});
  polygon.push_back({0, -0.1});
  return polygon;
}

/// A square whose sides are cut into many edges.
Polygon divided_square(int parts) {
  Polygon polygon;
  const Point2 corner[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int side = 0; side < 4; ++side)
    for (int k = 0; k < parts; ++k) {
      const Point2 a = corner[side], b = corner[(side + 1) % 4];
      polygon.push_back({a[0] + (b[0] - a[0]) * k / parts, a[1] + (b[1] - a[1]) * k / parts});
    }
  return polygon;
}

}  // namespace

TEST_CASE("crossings are those that a test of all pairs of edges finds", "[polygons]") {
  Dice dice(5);
  int wrong = 0, right = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const int count = 3 + static_cast<int>(uniform(dice, 0, trial % 3 == 0 ? 9 : 60));
    Polygon polygon = trial % 3 == 0   ? scattered(dice, count)
                      : trial % 3 == 1 ? star(dice, count)
                                       : spoilt(dice, count);
    if (trial % 2 == 1)
      polygon = turned_by(polygon, uniform(dice, 0, 7), std::pow(10, uniform(dice, -3, 4)),
                          {uniform(dice, -1e4, 1e4), uniform(dice, -1e4, 1e4)});
    const auto expected = first_of_all_pairs(polygon);
    ++(expected ? wrong : right);
    if (first_crossing(polygon) != expected) FAIL_CHECK("trial " << trial);
  }
  CHECK(wrong > 1500);
  CHECK(right > 1500);
}

TEST_CASE("an edge that is cut into parts does not cross itself, however it lies", "[polygons]") {
  Dice dice(6);
  for (int trial = 0; trial < 200; ++trial) {
    const Polygon square = turned_by(divided_square(1 + trial % 40), uniform(dice, 0, 7), 3,
                                     {uniform(dice, -100, 100), uniform(dice, -100, 100)});
    if (first_crossing(square) || first_of_all_pairs(square)) FAIL_CHECK("trial " << trial);
  }
}

TEST_CASE("few pairs of edges are tested, also of long thin teeth that lie askew", "[polygons]") {
  Dice dice(7);
  for (const Polygon& upright : {comb(500), star(dice, 2000), divided_square(500)})
    for (int trial = 0; trial < 20; ++trial) {
      const Polygon polygon = turned_by(upright, 0.1 * trial, 10, {3, -7});
      const int count = static_cast<int>(polygon.size());
      const EdgeTree tree(polygon);
      long looks = 0;
      for (int i = 0; i < count; ++i) {
        const int found = tree.first_near(i, [&](int k) { return ++looks, cross(polygon, i, k); });
        CHECK(found == count);
      }
      INFO("trial " << trial << ", " << count << " edges");
      CHECK(looks < count * (count * 0.06 + 30));
    }
}

TEST_CASE("the edges of a row are those that reach into it, in their order", "[polygons]") {
  Dice dice(8);
  for (int trial = 0; trial < 300; ++trial) {
    const Polygon polygon = star(dice, 3 + trial % 50);
    const EdgeTree tree(polygon);
    const double low = uniform(dice, -1.1, 1.1), high = low + uniform(dice, 0, 0.3);
    std::vector<int> found, expected;
    tree.in_row(low, high, [&](int k) { found.push_back(k); });
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Edge edge = edge_of(polygon, k);
      const auto [bottom, top] = std::minmax({edge.from[1], edge.to[1]});
      if (top >= low && bottom <= high) expected.push_back(static_cast<int>(k));
    }
    if (found != expected) FAIL_CHECK("trial " << trial);
  }
}
