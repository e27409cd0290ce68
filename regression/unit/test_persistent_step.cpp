// Whole steps in one launch, as small problems have them on a GPU: the same as function by function.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// n steps, up to `most` in one launch where that pays, else one by one in two; the sums of the first one,
/// and of each behind a rebuild, are made here.
template <class Space, class T, int Dim>
int steps_in_launches(State<Space, T, Dim>& s, double dt, int n, int most) {
  int rebuilds = 0;
  while (n > 0) {
    if (!s.summed.soil || s.summed.boundary != s.soil_boundary || !s.summed.rigids) {
      interpolate(s);
      s.summed = {true, s.soil_boundary, true};
    }
    const bool whole = can_persist(s);
    REQUIRE((whole || (!s.launch.co_resident && s.patches.slots > 1000)));
    restart_count(s);
    const int asked = whole ? run_persistent_steps(s, dt, std::min(n, most)) : 1;
    if (!whole) one_step(s, dt);
    const Control control = read_control(s);
    REQUIRE(control.fault_count == 0);
    REQUIRE((control.steps == asked || (control.paused != 0 && control.steps > 0)));
    if ((control.paused & Pause::not_co_resident) != 0) resume_single_steps(s);
    if ((control.paused & Pause::due) != 0) rebuild(s), ++rebuilds;
    n -= control.steps;
  }
  return rebuilds;
}

/// n steps, each function by itself on a device too.
template <class Space, class T, int Dim>
int steps_by_function(State<Space, T, Dim>& s, double dt, int n) {
  int rebuilds = 0;
  Timers timers;
  if (timers.create() != PETSC_SUCCESS) throw std::runtime_error("no timers");
  timers.sample(true);
  for (; n > 0; --n) {
    if (step(s, timers, dt) != PETSC_SUCCESS) throw std::runtime_error("a step failed");
    if (read_control(s).paused) rebuild(s), ++rebuilds;
  }
  return rebuilds;
}

/// Two rigids press into clay on a fixed base, one of them by a force on it if `dynamic`.
template <int Dim>
Cloud two_rigids(bool surface, bool dynamic) {
  constexpr double h = 0.1;
  const int width = Dim == 2 ? 26 : 9, depth = Dim == 2 ? 11 : 5;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({width, depth + 6, 5}, h, Wall::roller);
  cloud.grid.walls[1] = {Wall::fixed, Wall::free};
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, {double(width), double(depth), 5}, 2, h), 2, h, 1)};
  for (const double at : {0.0, Dim == 2 ? 15.0 : 6.0}) {
    RigidInput rigid =
        rigid_of<Dim>(lattice<Dim>({at, double(depth), 0}, {at + 3, depth + 1., 2}, 4, h), 4, h);
    rigid.surface_normal = surface;
    if (surface) {
      rigid.surface.centre = {(at + 1.5) * h, (depth + 0.5) * h, h};
      rigid.surface.half = {1.5 * h, 0.5 * h, h};
    }
    rigid.velocity = {0, -2, 0};
    cloud.rigids.push_back(rigid);
  }
  if (dynamic) cloud.rigids[1].dynamic = true, cloud.rigids[1].force = {0, -3e4, 0};
  cloud.gravity = {0, -9.81, 0};
  cloud.p2g.margin = 0.1;
  return cloud;
}

}  // namespace

TEST_CASE("a step in one launch is the step function by function, across rebuilds", "[persistent_step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const bool surface : {false, true}) {
      for (const bool dynamic : {false, true}) {
        for (const double f_bar : {0.0, 0.9}) {
          const int most = f_bar > 0 ? 1 : 7;
          Cloud cloud = two_rigids<B::dim>(surface, dynamic);
          cloud.f_bar_fraction = f_bar;
          if (f_bar > 0 && surface) {  // another material in the same cells
            constexpr double h = 0.1;
            cloud.materials[0].f_bar_share = 0.5;
            cloud.bodies.push_back(body_of<B::dim>(lattice<B::dim>({2, 1, 1}, {7, 4, 3}, 1, h), 1, h, 0));
          }
          auto one = state_of<B>(cloud, P2G::tile), two = state_of<B>(cloud, P2G::tile);
          interpolate(one);
          one.summed = {true, one.soil_boundary, true};
          const bool by_mass = dynamic && !surface;  // then the points move by forces that are not there yet
          INFO(B::name() << (surface ? " surface" : " mass") << (dynamic ? " dynamic" : "") << " F-bar "
                         << f_bar);
          if (by_mass)
            CHECK_FALSE(can_persist(one));
          else
            CHECK((can_persist(one) || B::dim == 3));  // in 3D a team may lack the memory
          if (!can_persist(one)) continue;
          const int steps = 60, rebuilds = steps_in_launches(one, 2e-4, steps, most);
          CHECK(rebuilds > 1);
          CHECK(steps_by_function(two, 2e-4, steps) == rebuilds);
          CHECK(largest_difference(soil_fields(one), soil_fields(two)) < B::of(1e-10, 1e-3));
          const auto ours = on_host(one.rigids), theirs = on_host(two.rigids);
          for (int r = 0; r < 2; ++r) {
            for (int d = 0; d < B::dim; ++d) {
              CHECK(std::fabs(ours(r).motion.pose.displacement[d] - theirs(r).motion.pose.displacement[d]) <
                    B::of(1e-12, 1e-6));
              CHECK(std::fabs(ours(r).impulse[d] - theirs(r).impulse[d]) <
                    B::of(1e-9, 1e-4) * std::fabs(theirs(r).impulse[1]));
            }
            CHECK(theirs(r).impulse[1] > 1);  // the soil resists
          }
          CHECK(std::fabs(read_control(one).bound - read_control(two).bound) < B::of(1e-10, 1e-6));
        }
      }
    }
  });
}

TEST_CASE("domains stretch in one launch as function by function, and heavy laws have no such launch",
          "[persistent_step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = two_rigids<B::dim>(true, false);
    cloud.stretch = true;
    auto one = state_of<B>(cloud, P2G::tile), two = state_of<B>(cloud, P2G::tile);
    interpolate(one);
    one.summed = {true, one.soil_boundary, true};
    INFO(B::name());
    one.light_laws = false;
    CHECK_FALSE(can_persist(one));
    one.light_laws = true;
    CHECK((can_persist(one) || B::dim == 3));
    if (!can_persist(one)) return;
    const auto begin = by_id(one.soil.points, one.soil.points.domain);
    const int steps = 60, rebuilds = steps_in_launches(one, 2e-4, steps, 7);
    CHECK(rebuilds > 1);
    CHECK(steps_by_function(two, 2e-4, steps) == rebuilds);
    CHECK(largest_difference(soil_fields(one), soil_fields(two)) < B::of(1e-10, 1e-3));
    const auto ours = by_id(one.soil.points, one.soil.points.domain);
    CHECK(largest_difference({ours}, {by_id(two.soil.points, two.soil.points.domain)}) < B::of(1e-10, 1e-3));
    CHECK(largest_difference({ours}, {begin}) > 1e-3);  // they have stretched
  });
}

TEST_CASE("steps in one launch and function by function take turns", "[persistent_step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = two_rigids<B::dim>(false, false);
    auto one = state_of<B>(cloud, P2G::tile), two = state_of<B>(cloud, P2G::tile);
    interpolate(one);
    one.summed = {true, one.soil_boundary, true};
    CHECK((can_persist(one) || B::dim == 3));
    if (!can_persist(one)) return;
    for (int n = 0; n < 4; ++n) {
      steps_in_launches(one, 2e-4, 5 + n, 4);
      steps_by_function(one, 2e-4, 1 + n);
    }
    steps_by_function(two, 2e-4, 5 + 6 + 7 + 8 + 1 + 2 + 3 + 4);
    INFO(B::name());
    CHECK(largest_difference(soil_fields(one), soil_fields(two)) < B::of(1e-10, 1e-3));
  });
}

TEST_CASE("teams that a device does not hold at once do one step a launch, or two", "[persistent_step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if constexpr (B::dim == 2) {
      for (const int width : {288, 512}) {  // cells: 648 and 2,048 patches
        Cloud cloud = two_rigids<2>(false, false);
        constexpr double h = 0.1;
        const int depth = width / 2;
        cloud.grid = grid_of<2>({width, depth + 6, 5}, h, Wall::roller);
        cloud.bodies = {body_of<2>(lattice<2>({0, 0, 0}, {double(width), double(depth), 5}, 2, h), 2, h, 1)};
        cloud.bodies[0].common_velocity = {1, -0.5, 0};
        cloud.rigids.clear();
        auto one = state_of<B>(cloud, P2G::tile), two = state_of<B>(cloud, P2G::tile);
        INFO(B::name() << ' ' << width);
        steps_in_launches(one, 2e-4, 10, 5);
        CHECK(one.launch.co_resident == !is_device<typename B::Space>);
        steps_by_function(two, 2e-4, 10);
        CHECK(largest_difference(soil_fields(one), soil_fields(two)) < B::of(1e-10, 1e-3));
      }
    }
  });
}
