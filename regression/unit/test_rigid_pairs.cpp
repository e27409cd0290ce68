// Contact between rigid bodies: places of contact, impulses, and tables of bodies.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"
#include "input/deck/body_table.hpp"
#include "physics/pair_contact.hpp"

using namespace mpm;
using Catch::Approx;

namespace {

/// A square of edge 1 m.
PairBody<2> square(double x, double y) {
  PairBody<2> body{};
  body.surface.kind = SurfaceKind::box;
  body.surface.centre = {x, y};
  body.surface.half = {0.5, 0.5};
  body.surface.cosine = 1;
  body.surface.round_off = 1e-9;
  return body;
}

PairMotion<2> moving(double mass, double inertia, Vector<double, 2> velocity) {
  PairMotion<2> motion{};
  motion.velocity = motion.before = velocity;
  motion.lightness = {1 / mass, 1 / mass};
  motion.ease[0] = 1 / inertia;
  return motion;
}

}  // namespace

TEST_CASE("a corner on the corner of an equal block touches its top", "[rigid_pairs]") {
  const PairBody<2> lower = square(0, 0);
  const Kokkos::View<Vertex*, Kokkos::HostSpace> none("none", 0);
  const double depth = 1e-6, inward = 0.01;
  RigidPose<2> pose{};
  pose.displacement = {0, -depth};
  for (const double side : {-1.0, 1.0}) {
    const SurfacePoint<2> corner{{0.5 * side, 0.5}, {-inward * side, inward}, 0};
    const Nearness<2> at = nearness(pose, corner, lower, RigidPose<2>{}, none);
    CHECK(at.normal[0] == Approx(0).margin(1e-12));
    CHECK(at.normal[1] == Approx(1));
    CHECK(at.gap == Approx(-depth).margin(1e-12));
  }
}

TEST_CASE("a corner beside a block is not on its top", "[rigid_pairs]") {
  const PairBody<2> lower = square(0, 0);
  const Kokkos::View<Vertex*, Kokkos::HostSpace> none("none", 0);
  const SurfacePoint<2> corner{{0.6, 0.5}, {0.01, 0.01}, 0};
  CHECK(nearness(RigidPose<2>{}, corner, lower, RigidPose<2>{}, none).gap > 0.05);
}

TEST_CASE("impulses of contact are opposite, press, and stay below the friction", "[rigid_pairs]") {
  test::Dice dice{std::mt19937_64(5)};
  std::uniform_real_distribution<double> draw(-1, 1);
  for (int n = 0; n < 200; ++n) {
    PairMotion<2> a = moving(2, 0.5, {draw(dice.engine), draw(dice.engine)}),
                  b = moving(3, 0.7, {draw(dice.engine), draw(dice.engine)});
    PairContact<2> at{};
    const double angle = M_PI * draw(dice.engine), friction = 0.3, restitution = 0.5, dt = 1e-3;
    at.normal = {std::cos(angle), std::sin(angle)};
    at.arms[0] = {draw(dice.engine), draw(dice.engine)}, at.arms[1] = {draw(dice.engine), draw(dice.engine)};
    set_bounds(at, a, b, restitution, dt);
    for (int sweep = 0; sweep < 200; ++sweep) relax_contact(at, a, b, friction);
    const double press = dot(at.impulse, at.normal), parts = dot(parting(at, a, b), at.normal);
    INFO("pair " << n);
    CHECK(press >= 0);
    CHECK(dot(at.impulse, at.impulse) <= press * press * (1 + friction * friction) * (1 + 1e-9));
    CHECK(parts >= at.least - 1e-9);
    if (at.before < 0) CHECK(parts == Approx(-restitution * at.before).margin(1e-9));
    for (int d = 0; d < 2; ++d) CHECK(a.impulse[d] == -b.impulse[d]);
  }
}

TEST_CASE("a table of rigid bodies gives options", "[rigid_pairs]") {
  std::string fault;
  const auto rows = rows_of_bodies("name, centre ,radius\n# two balls\na, 1 2  3 ,0.5\n\nb,4 5 6,\n", &fault);
  REQUIRE(fault.empty());
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].name == "a");
  CHECK(rows[0].options[0] == std::pair<std::string, std::string>("-a_centre", "1,2,3"));
  CHECK(rows[0].options[1].second == "0.5");
  CHECK(rows[1].options.size() == 1);
  for (const char* text :
       {"", "name,radius\n", "radius,name\n1,a\n", "name,radius\na\n", "name,radius\na b=,1\n"}) {
    fault.clear();
    CHECK((rows_of_bodies(text, &fault), !fault.empty()));
  }
}
