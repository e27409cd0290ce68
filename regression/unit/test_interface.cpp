// Contact between two velocity fields at a node.

#include <cmath>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include "physics/interface.hpp"

namespace mpm {
namespace {

using Catch::Approx;
using Side = InterfaceSide<double, 2>;

constexpr double k_spacing = 0.1, k_step = 1e-3;

/// A field of so much mass, whose face through the node is normal to y and covers the node's cells.
Side side_of(double mass, double out, Vector<double, 2> velocity) {
  Side side{};
  side.mass = side.moving = mass, side.velocity = velocity, side.strength = 1e3;
  side.area = {0, out * k_spacing};
  side.volume = k_spacing * k_spacing / 2;
  side.cloud = {{0, -out / 3}, {{1. / 6, 0}, {0, 1. / 18}}};  // of half the hat function of the node
  return side;
}

Meeting<double, 2> meeting_of(const Side& a, const Side& b) {
  Meeting<double, 2> at{};
  REQUIRE(meet(a, b, NodeCell<double>{k_spacing, k_spacing, 0}, at));
  return at;
}

InterfaceLaw law_with(double friction) {
  InterfaceLaw law;
  law.welded = false, law.friction = friction;
  return law;
}

InterfaceImpulse<double, 2> impulse_of(const InterfaceLaw& law, const Side& a, const Side& b) {
  SharedImpulse<double, 2> so_far;
  return impulse_between(law, a, b, meeting_of(a, b), k_spacing, k_step, so_far);
}

}  // namespace

TEST_CASE("fields that approach in touch leave with one velocity along the normal", "[interface]") {
  const Side a = side_of(2, 1, {0.3, 1}), b = side_of(6, -1, {0, -1});
  const Meeting<double, 2> at = meeting_of(a, b);
  CHECK(at.normal[1] == Approx(1));
  CHECK(at.gap == Approx(0).margin(1e-12));
  CHECK(at.area == Approx(k_spacing));
  const auto impulse = impulse_of(law_with(0), a, b);
  CHECK(a.velocity[1] + impulse.on_first[1] / a.mass == Approx(b.velocity[1] - impulse.on_first[1] / b.mass));
  CHECK(impulse.on_first[0] == Approx(0).margin(1e-15));
}

TEST_CASE("fields that part feel nothing, and a gap closes before they feel each other", "[interface]") {
  const Side a = side_of(2, 1, {0.3, -1}), b = side_of(6, -1, {0, 1});
  CHECK(impulse_of(law_with(0.5), a, b).on_first[1] == 0);
  Side low = side_of(2, 1, {0, 1}), high = side_of(6, -1, {0, 0});
  low.area[1] *= 0.8, low.volume *= 0.64;  // its face is 0.2 cells below the node
  CHECK(meeting_of(low, high).gap == Approx(0.2 * k_spacing));
  CHECK(impulse_of(law_with(0.5), low, high).on_first[1] == 0);
  low.velocity[1] = 1.5 * 0.2 * k_spacing / k_step;
  const double mass = 2.0 * 6 / 8;
  CHECK(impulse_of(law_with(0), low, high).on_first[1] == Approx(-mass * low.velocity[1] / 3));
}

TEST_CASE("the nodes beside two faces share their whole area, wherever the faces lie in a cell",
          "[interface]") {
  for (const double low : {0.1, 0.3, 0.5, 0.8})  // cells, of the faces above the lower of two rows of nodes
    for (const double high : {low, low + 0.1}) {
      double sum = 0;
      for (const int row : {0, 1}) {
        Side a = side_of(2, 1, {0, 0}), b = side_of(6, -1, {0, 0});
        const auto place = [&](Side& side, double up, double sign) {
          const double inside = sign * (up - row),
                       part = 1 - std::abs(inside);  // cells, of soil beyond the node
          side.area[1] = sign * part * k_spacing;
          side.volume = k_spacing * k_spacing * (inside > 0 ? 1 - part * part / 2 : part * part / 2);
        };
        place(a, low, 1), place(b, high, -1);
        sum += meeting_of(a, b).area;
      }
      CHECK(sum == Approx(k_spacing).epsilon(1e-6));
    }
  Side ground = side_of(6, 1, {0, 0}), block = side_of(2, -1, {0, 0});
  block.area[1] *= 0.3, block.volume *= 0.3;  // it reaches over 0.3 of the node's cells
  CHECK(meeting_of(ground, block).area == Approx(0.3 * k_spacing));
}

TEST_CASE("shear is the least of what stops the slip, friction with adhesion, and the limit", "[interface]") {
  const Side a = side_of(2, 1, {3, 1}), b = side_of(6, -1, {0, -1});
  const double mass = 1.5, normal = mass * 2, stops = mass * 3;
  CHECK(impulse_of(law_with(0.5), a, b).on_first[0] == Approx(-0.5 * normal));
  CHECK(impulse_of(law_with(9), a, b).on_first[0] == Approx(-stops));
  InterfaceLaw law = law_with(0.5);
  law.adhesion = 2000;
  CHECK(impulse_of(law, a, b).on_first[0] == Approx(-0.5 * normal - 2000 * k_spacing * k_step));
  law.shear_fraction = 0.5;  // of 1 kPa
  CHECK(impulse_of(law, a, b).on_first[0] == Approx(-500 * k_spacing * k_step));
  InterfaceLaw limit = law_with(-1);
  limit.shear_limit = 800;
  CHECK(impulse_of(limit, a, b).on_first[0] == Approx(-800 * k_spacing * k_step));
}

TEST_CASE("friction takes the kinetic energy of the slip that it stops", "[interface]") {
  const Side a = side_of(2, 1, {3, 1}), b = side_of(6, -1, {0, -1});
  const auto impulse = impulse_of(law_with(9), a, b);
  CHECK(impulse.work == Approx(1.5 * 3 * 3 / 2));
}

TEST_CASE("the corner of a block on flat ground has the normal of the ground", "[interface]") {
  Side corner = side_of(2, -1, {0, -1}), ground = side_of(6, 1, {0, 0});
  corner.area = {0.5 * k_spacing, -0.5 * k_spacing}, corner.volume /= 2;
  corner.cloud = {{-1. / 3, 1. / 3}, {{1. / 18, 0}, {0, 1. / 18}}};
  const Meeting<double, 2> at = meeting_of(corner, ground);
  CHECK(at.normal[0] / at.normal[1] == Approx(0).margin(0.01));
  CHECK(at.area < k_spacing);
}

TEST_CASE("the side of a block has the normal of ground that ends below the node", "[interface]") {
  constexpr double below = 0.6;  // cells, of the faces
  Side block = side_of(2, -1, {1, 0}), ground = side_of(6, 1, {0, 0});
  const double part = 1 - below, above = 0.5 + below - below * below / 2;
  ground.area = {0, part * k_spacing}, ground.volume = k_spacing * k_spacing * part * part / 2;
  ground.cloud = {{0, -below - part / 3}, {{1. / 6, 0}, {0, part * part / 18}}};
  block.area = {above * k_spacing, -0.5 * part * k_spacing}, block.volume = k_spacing * k_spacing * above / 2;
  block.cloud = {{-1. / 3, 0.06}, {{1. / 18, 0}, {0, 0.14}}};
  CHECK(std::abs(meeting_of(ground, block).normal[0]) < 0.01);
}

TEST_CASE(
    "gaps between the particles of a body that fills the node's cells leave the normal of a sliver on it",
    "[interface]") {
  Side sliver = side_of(0.01, -1, {8, 0}), full = side_of(6, 0, {0, 0});
  sliver.area = {0, -0.05 * k_spacing}, sliver.volume = 1.25e-3 * k_spacing * k_spacing;
  sliver.cloud = {{0, 0.97}, {{1. / 6, 0}, {0, 1e-4}}};
  full.area = {0.02 * k_spacing, 0}, full.volume = 0.999 * k_spacing * k_spacing;
  full.cloud = {{0, 0}, {{1. / 6, 0}, {0, 1. / 6}}};
  CHECK(meeting_of(sliver, full).normal[1] == Approx(-1));
  CHECK(meeting_of(full, sliver).normal[1] == Approx(1));
}

TEST_CASE("fields whose approach is round-off, as another one stops it, have no area in touch",
          "[interface]") {
  Side a = side_of(2, 1, {0, 1e-17}), b = side_of(6, -1, {0, 0});
  a.round_off = 1e-14;
  CHECK(impulse_of(law_with(0), a, b).area == 0);
  a.velocity[1] = 1e-10;
  CHECK(impulse_of(law_with(0), a, b).area == Approx(k_spacing));
}

TEST_CASE("a pair takes its part of the impulse that stops two fields, and another pair the rest",
          "[interface]") {
  Side a = side_of(2, 1, {0.3, 1}), b = side_of(6, -1, {0, -1});
  SharedImpulse<double, 2> of_first, of_second;
  const InterfaceLaw law = law_with(0.5);
  const auto whole = impulse_of(law, a, b);
  const auto first = impulse_between(law, a, b, meeting_of(a, b), k_spacing, k_step, of_first, 0.25);
  CHECK(first.on_first[1] == Approx(0.25 * whole.on_first[1]));
  for (int d = 0; d < 2; ++d)
    a.velocity[d] += first.on_first[d] / a.mass, b.velocity[d] -= first.on_first[d] / b.mass;
  const auto second = impulse_between(law, a, b, meeting_of(a, b), k_spacing, k_step, of_second);
  for (int d = 0; d < 2; ++d) CHECK(first.on_first[d] + second.on_first[d] == Approx(whole.on_first[d]));
  CHECK(first.work + second.work == Approx(whole.work));
}

TEST_CASE("soil that goes through a node's cells is broad, soil that ends at the node is not",
          "[interface]") {
  const SoilCloud<double, 2> half{{0, -1. / 3}, {{1. / 6, 0}, {0, 1. / 18}}};
  CHECK(half.breadth({0, 1}) == Approx(1));
  const SoilCloud<double, 2> end{{-1. / 3, -1. / 3}, {{1. / 18, 0}, {0, 1. / 18}}};
  CHECK(end.breadth({0, 1}) == Approx(std::sqrt(1. / 3)));
  const SoilCloud<double, 3> slab{{0, 0, -0.5}, {{1. / 6, 0, 0}, {0, 1. / 6, 0}, {0, 0, 0.01}}};
  CHECK(slab.breadth({0, 0, 1}) == Approx(1));
  const SoilCloud<double, 3> beam{{0, -1. / 3, -0.5}, {{1. / 6, 0, 0}, {0, 1. / 18, 0}, {0, 0, 0.01}}};
  CHECK(beam.breadth({0, 0, 1}) == Approx(std::sqrt(1. / 3)));
}

TEST_CASE("a sliver in the corner of a node's cells has the normal, not the end of what it lies on",
          "[interface]") {
  const double edge = 0.3, across = std::sqrt(0.5);
  Side ground = side_of(0.01, 1, {0, 0}), block = side_of(6, -1, {1, -1});
  ground.volume = std::pow(edge, 4) / 24 * k_spacing * k_spacing;
  ground.area = {std::pow(edge, 3) / 6 * k_spacing, std::pow(edge, 3) / 6 * k_spacing};
  ground.cloud = {
      {0.4 * edge - 1, 0.4 * edge - 1},
      {{0.04 * edge * edge, -0.08 / 3 * edge * edge}, {-0.08 / 3 * edge * edge, 0.04 * edge * edge}}};
  block.volume = 0.7 * k_spacing * k_spacing,
  block.area = {0.6 * across * k_spacing, -0.6 * across * k_spacing};
  block.cloud = {{-0.15, 0.15}, {{0.14, 0.02}, {0.02, 0.14}}};
  const auto normal = meeting_of(ground, block).normal;
  CHECK(normal[0] == Approx(across).margin(0.01));
  CHECK(normal[1] == Approx(across).margin(0.01));
}

TEST_CASE("the impulses of several rounds obey the limits of one", "[interface]") {
  Side a = side_of(2, 1, {3, 1}), b = side_of(6, -1, {0, -1});
  InterfaceLaw law = law_with(0.5);
  law.shear_limit = 4000;
  SharedImpulse<double, 2> so_far;
  double along = 0, area = 0;
  for (int round = 0; round < 5; ++round) {
    const auto impulse = impulse_between(law, a, b, meeting_of(a, b), k_spacing, k_step, so_far);
    along += impulse.on_first[0], area += impulse.area;
    for (int d = 0; d < 2; ++d)
      a.velocity[d] += impulse.on_first[d] / a.mass, b.velocity[d] -= impulse.on_first[d] / b.mass;
    b.velocity[1] -= 0.1;  // a third body pushes
  }
  CHECK(along == Approx(-4000 * k_spacing * k_step));
  CHECK(area == Approx(k_spacing));
  CHECK(a.velocity[1] == Approx(b.velocity[1] + 0.1));
}

}  // namespace mpm
