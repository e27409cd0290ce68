// The movement bound: how long bins and lists are used, and the faults that stop the steps.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_spacing = 0.1;

/// A block of soil in the middle of a mesh with free sides, all with one velocity [m/s], and a rigid apart
/// from it. The soil is so soft that steps of any length here are stable.
template <int Dim>
Cloud block(std::array<double, 3> velocity) {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({24, 20, 16}, k_spacing, Wall::free);
  cloud.materials = {{0, {1e-3, 0.3}}, {1, {1e-3, 0.3, 1, 0, 0}}};
  cloud.bodies = {body_of<Dim>(lattice<Dim>({8, 8, 8}, {12, 11, 10}, 2, k_spacing), 2, k_spacing, 0)};
  cloud.bodies[0].common_velocity = velocity;
  cloud.rigids = {rigid_of<Dim>(lattice<Dim>({1, 1, 1}, {3, 2, 2}, 4, k_spacing), 4, k_spacing)};
  return cloud;
}

/// Everything that a step may change.
template <class Space, class T, int Dim>
std::vector<Table> everything(const State<Space, T, Dim>& s) {
  auto all = carried_fields(s.soil.points);
  all.push_back(by_id(s.soil.points, s.soil.points.coordinate));
  for (const auto& set : s.rigid_points) all.push_back(by_id(set.points, set.points.coordinate));
  for (auto& field : nodal_fields(s)) all.push_back(field);
  all.push_back(nodes_of(s, s.nodes.kinematics));
  const auto rigids = on_host(s.rigids);
  for (std::size_t r = 0; r < rigids.extent(0); ++r)
    all.push_back({1,
                   {rigids(r).motion.pose.displacement[0], rigids(r).motion.pose.displacement[1],
                    rigids(r).motion.velocity[1], rigids(r).impulse[1]}});
  return all;
}

/// The time step in which a point of the given speed [m/s] moves so many cells.
double time_to_move(double cells, double speed) { return cells * k_spacing / speed; }

/// The state after at most n steps, or at the first fault.
template <class B>
Control control_after(const Cloud& cloud, double dt, int n) {
  auto s = state_of<B>(cloud, P2G::automatic);
  run_steps(s, dt, n);
  return read_control(s);
}

}  // namespace

TEST_CASE("steps go on until the bound has passed the margin, and not one step less or more",
          "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (double margin : {0.5, 0.25})
      for (double cells : {0.12, 0.0499, 0.1001}) {
        INFO(build.name() << " margin " << margin << " cells a step " << cells);
        Cloud cloud = block<B::dim>({2, -1, 0.5});
        cloud.p2g.margin = margin;
        auto s = state_of<B>(cloud, P2G::tile);
        const int last =
            static_cast<int>(margin / cells) + 1;  // the first step after which they have moved further
        for (int n = 1; n <= last; ++n) {
          REQUIRE(read_control(s).paused == 0);
          one_step(s, time_to_move(cells, 2));
          CHECK(std::fabs(read_control(s).bound - n * cells) < B::of(1e-11, 1e-5));
          CHECK(read_control(s).bound >= n * cells * (1 - 1e-15));
        }
        CHECK(read_control(s).paused == 1);
        CHECK(read_control(s).steps == last);
        CHECK(read_control(s).fault_count == 0);
      }
  });
}

TEST_CASE("the bound counts the fastest of soil and rigids", "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    Cloud cloud = block<B::dim>({1, 0, 0});
    cloud.rigids[0].velocity = {0, -3, 0};
    auto s = state_of<B>(cloud);
    one_step(s, 0.004);
    CHECK(std::fabs(read_control(s).bound - 0.12) < B::of(1e-14, 1e-6));
  });
}

TEST_CASE("the bound is the sum of the furthest movements of each step, and no particle has gone further",
          "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    Cloud cloud = random_cloud<B::dim>(3);
    cloud.rigids.resize(1);  // moves by less than the soil
    auto s = state_of<B>(cloud, P2G::tile);
    const Table start = soil_fields(s)[0];
    Table before = start;
    double sum = 0;
    for (int n = 0; n < 5; ++n) {
      one_step(s, 2e-5);
      const Table now = soil_fields(s)[0];
      double step = 0, far = 0;
      for (std::size_t k = 0; k < now.value.size(); ++k) {
        step = std::max(step, std::fabs(now.value[k] - before.value[k]));
        far = std::max(far, std::fabs(now.value[k] - start.value[k]));
      }
      sum += step;
      before = now;
      CHECK(read_control(s).bound >= far - B::of(1e-13, 0));
      CHECK(std::fabs(read_control(s).bound - sum) < (n + 1) * B::of(1e-13, 3e-7));
    }
  });
}

TEST_CASE("no step after the bound has passed the margin changes a bit, and a rebuild lets them go on",
          "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (P2G how : k_strategies) {
      INFO(build.name() << ' ' << word_of(how));
      Cloud cloud = block<B::dim>({2, -1, 0.5});
      cloud.rigids[0].velocity = {0.1, 0.2, 0};
      cloud.rigids[0].shear_limit = 100;
      auto s = state_of<B>(cloud, how);
      for (int n = 0; n < 3; ++n) one_step(s, time_to_move(0.2, 2));
      REQUIRE(read_control(s).paused == 1);
      const auto before = everything(s);
      const Control control = read_control(s);
      for (int n = 0; n < 3; ++n) one_step(s, time_to_move(0.2, 2));
      CHECK(everything(s) == before);
      CHECK(read_control(s).steps == control.steps);
      CHECK(read_control(s).bound == control.bound);
      rebuild(s);
      CHECK(read_control(s).paused == 0);
      CHECK(read_control(s).bound == 0);
      CHECK(read_control(s).steps == 3);
      one_step(s, time_to_move(0.2, 2));
      CHECK(read_control(s).steps == 4);
      CHECK(largest_difference(by_id(s.soil.points, s.soil.points.coordinate), before[6]) > 0.1);
    }
  });
}

TEST_CASE("a particle that leaves the mesh at a free side is no fault", "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    Cloud cloud = block<B::dim>({0, 0, 0});
    auto lone = body_of<B::dim>({0.55, 1.93, 0.55}, 2, k_spacing, 0);  // the mesh ends at y = 2
    lone.position.resize(B::dim), strength_of(lone).resize(1);
    lone.common_velocity = {0, 1, 0};
    cloud.bodies.push_back(lone);
    CHECK(control_after<B>(cloud, 0.02, 20).fault_count == 0);
  });
}

TEST_CASE("a rigid that leaves the mesh is reported by its number", "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    Cloud cloud = block<B::dim>({0, 0, 0});
    cloud.rigids.push_back(cloud.rigids[0]);
    cloud.rigids[1].velocity = {-1, 0, 0};
    const Control control = control_after<B>(cloud, 0.02, 20);
    REQUIRE(control.fault_count > 0);
    CHECK(control.fault.kind == FaultKind::outside);
    CHECK(control.fault.particle == -2);
    CHECK(control.fault.position[0] < 0);
  });
}

TEST_CASE("a value that is not finite is reported with its particle, and nothing goes on",
          "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinite = std::numeric_limits<double>::infinity();
    for (double wrong : {nan, infinite})
      for (bool in_stress : {false, true}) {
        INFO(build.name() << ' ' << wrong << (in_stress ? " in the stress" : " in the velocity"));
        Cloud cloud = block<Dim>({0, 0, 0});
        auto lone = body_of<Dim>({0.55, 1.73, 0.55}, 2, k_spacing, 1);
        lone.position.resize(Dim), strength_of(lone).resize(1);
        lone.stress.assign(sym_size<Dim>, 0.0);
        lone.velocity.assign(Dim, 0.0);
        (in_stress ? lone.stress : lone.velocity)[Dim - 1] = wrong;
        cloud.bodies.push_back(lone);
        auto s = state_of<B>(cloud);
        one_step(s, 1e-4);
        const Control control = read_control(s);
        REQUIRE(control.fault_count == 1);
        CHECK(control.fault.kind == FaultKind::not_finite);
        CHECK(control.fault.particle == static_cast<int>(strength_of(cloud.bodies[0]).size()));
        CHECK(control.paused == 1);
        one_step(s, 1e-4);
        CHECK(read_control(s).steps == 1);
      }
  });
}

TEST_CASE("a particle that outruns the bins in one step is reported as too fast", "[movement_bound]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    Cloud cloud = block<B::dim>({0, 0, 0});
    auto lone = body_of<B::dim>({0.55, 1.05, 0.55}, 2, k_spacing, 0);
    lone.position.resize(B::dim), strength_of(lone).resize(1);
    lone.common_velocity = {0, -1, 0};
    cloud.bodies.push_back(lone);
    const Control control = control_after<B>(cloud, time_to_move(3, 1), 1);
    REQUIRE(control.fault_count == 1);
    CHECK(control.fault.kind == FaultKind::too_fast);
    CHECK(control.fault.particle == static_cast<int>(strength_of(cloud.bodies[0]).size()));
  });
}
