// Energy without a source, Courant numbers, and notices that the log prints once.

#include <algorithm>
#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "check/energy_watch.hpp"
#include "check/notices.hpp"
#include "common/courant.hpp"
#include "common/gravity_on_soil.hpp"

using namespace mpm;

namespace {

Config config_of_one_body() {
  Config config;
  config.gravity = {0, -10, 0};
  config.mesh.upper = {4, 3, 0}, config.mesh.spacing = 0.1;
  config.bodies.resize(1);
  config.bodies[0].name = "soil";
  return config;
}

/// One body of 2 kg at this height [m], with this kinetic energy [J].
HistoryRow row_of(double height, double energy) {
  HistoryRow row;
  row.step = 1;
  row.bodies.resize(1);
  row.bodies[0].mass = 2;
  row.bodies[0].centre = {1, height, 0};
  row.bodies[0].kinetic_energy = energy;
  return row;
}

}  // namespace

TEST_CASE("soil may have the energy that it began with and what gravity gives it, and no more",
          "[energy_watch]") {
  const Config config = config_of_one_body();
  EnergyWatch watch;
  watch.begin(row_of(2, 1), 1e6);
  CHECK(watch.check(row_of(1.5, 11), config).empty());  // fell by 0.5 m
  CHECK(watch.check(row_of(2, 1), config).empty());     // and rose again
  CHECK(watch.check(row_of(2, 9), config).empty());     // within half of what has passed, 21 J
  CHECK_FALSE(watch.check(row_of(2, 13), config).empty());
}

TEST_CASE("gravity in time gives at most its largest value times the way, though the centre has come back",
          "[energy_watch]") {
  Config config = config_of_one_body();
  config.gravity_table = TimeTable{.times = {0, 1}, .values = {{0, -10, 0}, {0, 10, 0}}};
  EnergyWatch watch;
  watch.begin(row_of(2, 0), 1e6);
  HistoryRow row = row_of(2, 19);  // 2 kg have 1 m/s and gain up to 1 m/s in 0.1 s: 4 J a row
  row.time = 0.1, row.bodies[0].momentum = {0, -2, 0};
  CHECK_FALSE(watch.check(row, config).empty());
  watch.begin(row_of(2, 0), 1e6);
  row.bodies[0].kinetic_energy = 5.9;  // within half of what has passed
  CHECK(watch.check(row, config).empty());
}

TEST_CASE("a rigid body that only turns gives soil the work of its moment", "[energy_watch]") {
  Config config = config_of_one_body();
  config.gravity = {};
  RigidConfig vane;
  vane.motion = Motion::prescribed, vane.angular_velocity = {3, 0, 0};
  config.rigids.push_back(vane);
  const auto row = [](double time, double energy) {
    HistoryRow at = row_of(2, energy);
    at.time = time, at.rigids.resize(1);
    at.rigids[0].moment = {-20, 0, 0}, at.rigids[0].angular_velocity = {3, 0, 0};
    return at;
  };
  EnergyWatch watch;
  watch.begin(row(0, 0), 1e6);
  CHECK(watch.check(row(0.5, 29), config).empty());  // 20 N m over 1.5 rad
  watch.begin(row(0, 0), 1e6);
  CHECK_FALSE(watch.check(row(0.5, 46), config).empty());  // beyond half of what has passed
}

TEST_CASE("water that covers all soil of one density takes the same share of gravity everywhere",
          "[energy_watch][pore_water]") {
  Config config = config_of_one_body();
  config.materials.resize(2);
  config.materials[0].density = 2000, config.materials[1].density = 1800;
  config.bodies.push_back(config.bodies[0]);
  CHECK_FALSE(carries_alike(config));
  CHECK(gravity_on_soil(config) == config.gravity);
  config.water = {.level = 3.09, .density = 1000};  // the mesh ends at 3 m, and its cells are of 0.1 m
  CHECK_FALSE(carries_alike(config));
  config.water.level = 3.1001;
  CHECK(carries_alike(config));
  CHECK(gravity_on_soil(config)[1] == -5);
  config.gravity = {6, -8, 0};  // heights are against gravity: 0.8 y - 0.6 x
  config.water.level = 2.4 + 0.0999;
  CHECK_FALSE(carries_alike(config));
  config.water.level = 2.4 + 0.1001;
  CHECK(carries_alike(config));
  CHECK(gravity_on_soil(config)[0] == 3);
  config.bodies[1].material = 1;
  CHECK_FALSE(carries_alike(config));
  CHECK(gravity_on_soil(config) == config.gravity);
}

TEST_CASE("a body that sinks through covering water has the buoyant weight's energy",
          "[energy_watch][pore_water]") {
  Config config = config_of_one_body();
  config.materials.resize(1);
  config.materials[0].density = 2000;
  config.water = {.level = 20, .density = 1000};
  EnergyWatch watch;
  watch.begin(row_of(2, 1), 1e6);
  CHECK(watch.check(row_of(1, 11), config).empty());  // 2 kg by 1 m and 5 m/s2
  CHECK_FALSE(watch.check(row_of(1, 18), config).empty());
}

TEST_CASE("stored energy and the work of rigids are sources", "[energy_watch]") {
  Config config = config_of_one_body();
  config.rigids.resize(1);
  EnergyWatch watch;
  HistoryRow start = row_of(2, 0);
  start.bodies[0].stored_energy = 5;
  start.rigids.resize(1);
  watch.begin(start, 1e6);
  HistoryRow pushed = row_of(2, 8);
  pushed.rigids.resize(1);
  pushed.rigids[0].force = {0, 30, 0}, pushed.rigids[0].displacement = {0, -0.1, 0};
  CHECK(watch.check(pushed, config).empty());
  EnergyWatch without;
  without.begin(row_of(2, 0), 1e6);
  CHECK_FALSE(without.check(row_of(2, 8), config).empty());
}

TEST_CASE("round-off is no energy, and soil that leaves begins the account anew", "[energy_watch]") {
  const Config config = config_of_one_body();
  EnergyWatch watch;
  watch.begin(row_of(2, 0), 1e6);
  CHECK(watch.check(row_of(2, 5e-5), config).empty());
  HistoryRow left = row_of(3, 100);
  left.bodies[0].lost_count = 1;
  CHECK(watch.check(left, config).empty());
  HistoryRow next = row_of(3, 160);
  next.bodies[0].lost_count = 1;
  CHECK_FALSE(watch.check(next, config).empty());
}

TEST_CASE("the largest Courant number is that of the rim of the body with the most particles",
          "[energy_watch]") {
  for (int dim : {2, 3})
    for (int n : {1, 2, 3, 4, 6, 8, 12, 16}) {
      Config config = config_of_one_body();
      config.dim = dim;
      config.bodies.resize(2);
      config.bodies[1].shape.particles_per_cell = n;
      config.bodies[0].shape.particles_per_cell = std::max(1, n - 1);
      const double rim = n == 1 ? std::sqrt(2.0 / (3 * dim)) : std::sqrt(2.0 / (dim * n));
      const double body = n == 2 ? std::sqrt(2.0 / (3 * dim)) : rim;  // the other body's with n = 2
      const double expected = std::min(0.6, body);
      CHECK(largest_courant(config) == Catch::Approx(expected));
      CHECK(standard_courant(config) == Catch::Approx(std::min(0.5, 0.95 * expected)));
      config.f_bar_fraction = 0;
      CHECK(largest_courant(config) == Catch::Approx(std::min(0.6, 0.94 * body)));
      config.f_bar_fraction = 0.98, config.damping = 0.44;
      CHECK(largest_courant(config) == Catch::Approx(std::min(0.6, body / 1.2)));
    }
}

TEST_CASE("the log reports once what happens to soil for the first time", "[energy_watch]") {
  Config config = config_of_one_body();
  Notices notices;
  HistoryRow row = row_of(1, 0);
  CHECK(notices.report(row, config).empty());
  row.bodies[0].strays = 3, row.bodies[0].put_back = 1;
  CHECK(notices.report(row, config).size() == 2);
  row.bodies[0].limited = 2;
  CHECK(notices.report(row, config).size() == 1);
  row.bodies[0].lost_count = 1, row.bodies[0].upper = {2, 2.98, 0};
  const auto lines = notices.report(row, config);
  REQUIRE(lines.size() == 2);
  CHECK(lines[1].find("-mesh_ymax") != std::string::npos);
  CHECK(notices.report(row, config).empty());
}

TEST_CASE("the log reports once gaps, energy that is missing, and energy that the velocity update damps",
          "[energy_watch]") {
  Config config = config_of_one_body();
  config.output.energy = true;
  Notices notices;
  HistoryRow row = row_of(1, 100);
  const auto count_of = [&](const std::string& what) {
    const auto lines = notices.report(row, config);
    return std::count_if(lines.begin(), lines.end(),
                         [&](const std::string& line) { return line.find(what) != std::string::npos; });
  };
  row.step = 200;
  row.filled_cells = 1000, row.empty_cells = 10;
  row.energy.gravity = 100, row.energy.kinetic = 80, row.energy.error = -5, row.energy.update = -20;
  CHECK(notices.report(row, config).empty());  // at the limits
  row.empty_cells = 11;
  CHECK(count_of("hold no particle") == 1);
  CHECK(count_of("hold no particle") == 0);
  row.energy.error = -5.1;
  row.step = 50;
  CHECK(count_of("energy_error") == 0);  // the works of few steps
  row.step = 200;
  CHECK(count_of("energy_error") == 1);
  row.energy.update = -21;
  CHECK(count_of("work_update") == 1);
  row.energy.update = -50, row.energy.error = 50;
  CHECK(notices.report(row, config).empty());
}
