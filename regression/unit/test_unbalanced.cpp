// The unbalanced forces of soil.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "transfer/unbalanced.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double h = 0.25, k_gravity = 10;

/// Level ground between rollers, `carried` of whose weight its stress carries.
template <int Dim>
Cloud level_ground(double carried) {
  const int width = 5, depth = 7, up = Dim - 1;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({width, Dim == 2 ? depth + 2 : 4, depth + 2}, h, Wall::roller);
  cloud.materials = clays();
  std::array<double, 3> high{double(width), 4, double(depth)};
  high[up] = depth;
  BodyInput body = body_of<Dim>(lattice<Dim>({0, 0, 0}, high, 2, h), 2, h, 0);
  for (std::size_t p = 0; p < body.position.size() / Dim; ++p)
    for (int k = 0; k < sym_size<Dim>; ++k)
      body.stress.push_back(
          k < 3 ? -carried * k_density * k_gravity * (depth * h - body.position[p * Dim + up]) : 0);
  cloud.bodies = {body};
  cloud.gravity[up] = -k_gravity;
  return cloud;
}

template <class B>
UnbalancedForces forces_of(const Cloud& cloud) {
  auto s = state_of<B>(cloud, P2G::tile);
  sum_present_soil(s);
  return unbalanced_forces(s, 1e-4);
}

}  // namespace

TEST_CASE("level ground that carries its weight has no unbalanced force, and half of it has half",
          "[unbalanced]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(B::name());
    for (const double carried : {0.0, 0.5, 1.0}) {
      const UnbalancedForces sum = forces_of<B>(level_ground<B::dim>(carried));
      REQUIRE(sum.weight > 0);
      CHECK(std::fabs(sum.force / sum.weight - (1 - carried)) < B::of(1e-13, 1e-5));
    }
  });
}

TEST_CASE("a plate on level ground leaves it in balance, and holds soil that is pressed into it",
          "[unbalanced]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(B::name());
    Cloud cloud = level_ground<B::dim>(1), pressed = level_ground<B::dim>(0);
    for (double& g : pressed.gravity) g = -g;
    const double weight = forces_of<B>(cloud).weight, out_of_balance = forces_of<B>(pressed).force;
    RigidInput plate = rigid_of<B::dim>(
        lattice<B::dim>({1, B::dim == 2 ? 7. : 1., 7}, {3, B::dim == 2 ? 8. : 3., 8}, 4, h), 4, h);
    plate.surface_normal = true;
    plate.surface.centre = {2 * h, (B::dim == 2 ? 7.5 : 2) * h, 7.5 * h};
    plate.surface.half = {h, (B::dim == 2 ? 0.5 : 1) * h, 0.5 * h};
    cloud.rigids = pressed.rigids = {plate};
    const UnbalancedForces rests = forces_of<B>(cloud);
    CHECK(std::fabs(rests.weight / weight - 1) < B::of(1e-13, 1e-5));
    CHECK(rests.force < B::of(1e-13, 1e-5) * weight);
    const double held = 1 - forces_of<B>(pressed).force / out_of_balance;
    CHECK((held > 0.02 && held < 0.5));
  });
}
