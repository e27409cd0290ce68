// Tables in time: the mean of a curve over a step, and loads that follow tables on every backend.

#include <unistd.h>

#include <catch2/catch_test_macros.hpp>
#include <filesystem>
#include <fstream>

#include "compare.hpp"
#include "input/files/time_table.hpp"
#include "transfer/upload_loads.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Sum of the means of a curve over steps of dt, times dt, from one time to another.
double sum_of_means(const TimeCurve& curve, CurveUse use, double from, double to, double dt) {
  double sum = 0;
  int near = -1;
  for (double t = from; t < to - 1e-12; t += dt) {
    const double step = std::min(dt, to - t);
    sum += step * curve.mean(use, t, step, near);
  }
  return sum;
}

const std::vector<CurvePoint> k_zigzag = {{0, 0}, {1, 1}, {2, -1}, {3, 0}};

LoadInput load_of(LoadTarget target, int rigid, int d, std::vector<CurvePoint> points,
                  CurveUse use = CurveUse::value) {
  return {.target = target, .rigid = rigid, .component = d, .own = {0, std::move(points), use, false}};
}

/// A rigid presses into clay by a velocity in time, under gravity in time.
template <int Dim>
Cloud pressed_clay() {
  constexpr double h = 0.1;
  const int width = Dim == 2 ? 14 : 10, depth = Dim == 2 ? 8 : 4;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({width, depth + 6, 5}, h, Wall::roller);
  cloud.grid.walls[1] = {Wall::fixed, Wall::free};
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, {double(width), double(depth), 5}, 2, h), 2, h, 1)};
  RigidInput rigid = rigid_of<Dim>(lattice<Dim>({2, double(depth), 0}, {5, depth + 1., 2}, 4, h), 4, h);
  rigid.surface_normal = true;
  rigid.surface.centre = {3.5 * h, (depth + 0.5) * h, h};
  rigid.surface.half = {1.5 * h, 0.5 * h, h};
  cloud.rigids = {rigid, rigid};
  cloud.rigids[0].timed = true;
  cloud.rigids[1].dynamic = true, cloud.rigids[1].force = {0, -3e3, 0};
  for (std::size_t k = 0; k < cloud.rigids[1].position.size(); k += Dim)
    cloud.rigids[1].position[k] += 3.2 * h;
  cloud.rigids[1].surface.centre[0] += 3.2 * h;
  cloud.p2g.margin = 0.1;
  return cloud;
}

const std::vector<CurvePoint> k_velocity = {{0, 0}, {0.0031, -2}, {0.0047, 1}, {1, 1}};
const std::vector<CurvePoint> k_gravity = {{-1, 0}, {0.002, -9.81}, {0.006, -20}, {1, -20}};

std::vector<LoadInput> loads_of_clay() {
  LoadInput force = load_of(LoadTarget::force, 1, 1, {{0, -3e3}, {0.004, -9e3}, {1, -9e3}});
  force.gravity = {0, k_gravity}, force.factor = 2;
  return {load_of(LoadTarget::gravity, 0, 1, k_gravity), load_of(LoadTarget::velocity, 0, 1, k_velocity),
          force};
}

/// n steps of dt in calls of `most` at most, each of which begins the loads anew; by persistent steps or one
/// by one.
template <class Space, class T, int Dim>
void timed_steps(State<Space, T, Dim>& s, double dt, int n, int most, bool persistent) {
  for (int done = 0; done < n;) {
    restart_count(s);
    begin_loads(s, s.timed, {0, dt, done, dt});
    int left = std::min(most, n - done);
    while (left > 0) {
      int asked = 1;
      if (persistent) {
        if (!s.summed.soil || s.summed.boundary != s.soil_boundary || !s.summed.rigids) {
          interpolate(s);
          s.summed = {true, s.soil_boundary, true};
        }
        asked = run_persistent_steps(s, dt, left);
      } else {
        one_step(s, dt);
      }
      const Control control = read_control(s);
      REQUIRE(control.fault_count == 0);
      if (control.paused != 0) break;
      left -= asked;
    }
    const Control control = read_control(s);
    done += control.steps;
    if ((control.paused & Pause::not_co_resident) != 0) resume_single_steps(s);
    if ((control.paused & Pause::due) != 0) rebuild(s);
  }
}

}  // namespace

TEST_CASE("the means of a curve over steps add up to its integral, corners between steps or on them",
          "[time_tables]") {
  const TimeCurve curve{k_zigzag.data(), 4, false}, smooth{k_zigzag.data(), 4, true};
  for (const double dt : {0.07, 0.1, 0.25, 1.7, 3.0}) {
    for (const auto& [to, travel] : {std::pair{1.0, 0.5}, {1.5, 0.75}, {2.0, 0.5}, {3.0, 0.0}}) {
      INFO(dt << " " << to);
      CHECK(std::fabs(sum_of_means(curve, CurveUse::value, 0, to, dt) - travel) < 1e-12);
      if (to != 1.5) CHECK(std::fabs(sum_of_means(smooth, CurveUse::value, 0, to, dt) - travel) < 1e-12);
    }
    for (const TimeCurve& of : {curve, smooth})
      CHECK(std::fabs(sum_of_means(of, CurveUse::rate, 0, 1.3, dt) - of.value(1.3)) < 1e-12);
  }
  CHECK((smooth.value(0.5) == 0.5 && std::fabs(smooth.value(0.25) - 0.15625) < 1e-15));
  CHECK((smooth.rate(1) == 0 && smooth.rate(0.5) == 1.5 && curve.rate(1.2) == -2));
  // The cubic x^2 (3 - 2 x) from 0.1 to 0.7.
  int near = 0;
  const auto integral = [](double x) { return x * x * x - x * x * x * x / 2; };
  CHECK(std::fabs(0.6 * smooth.mean(CurveUse::value, 0.1, 0.6, near) - (integral(0.7) - integral(0.1))) <
        1e-15);
}

TEST_CASE("a curve has its end values outside, one value gives its bits, and the search may begin anywhere",
          "[time_tables]") {
  const TimeCurve curve{k_zigzag.data(), 4, false};
  CHECK((curve.value(-1) == 0 && curve.value(5) == 0 && curve.rate(-1) == 0 && curve.rate(3) == 0));
  const std::vector<CurvePoint> flat = {{0, 0.1}, {0.3, 0.1}, {0.7, 0.1}, {2, 0.1}};
  for (const bool smooth : {false, true}) {
    int near = 0;
    for (double t = -0.5; t < 3; t += 0.137)
      CHECK(TimeCurve{flat.data(), 4, smooth}.mean(CurveUse::value, t, 0.61, near) == 0.1);
  }
  Dice dice{std::mt19937_64(4)};
  int kept = 0;
  for (int n = 0; n < 1000; ++n) {
    int fresh = -1 + dice.below(6);
    const double t = dice.uniform(-1, 4), dt = dice.uniform(0.01, 2);
    const double mean = curve.mean(CurveUse::value, t, dt, kept);
    CHECK(mean == curve.mean(CurveUse::value, t, dt, fresh));
    CHECK(fresh == kept);
  }
}

TEST_CASE("loads follow their tables on the device, however steps are launched", "[time_tables]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(B::name());
    const double dt = 1e-4;
    const int steps = 80;
    std::vector<StateOf<B>> states;
    for (const auto& [most, persistent] : {std::pair{1, false}, {7, false}, {80, false}, {13, true}}) {
      states.push_back(state_of<B>(pressed_clay<B::dim>(), P2G::tile));
      auto& s = states.back();
      if (persistent && !can_persist(s)) {
        interpolate(s);
        s.summed = {true, s.soil_boundary, true};
        if (!can_persist(s)) {  // in 3D a team may lack the memory
          states.pop_back();
          continue;
        }
      }
      upload_loads(s, loads_of_clay());
      timed_steps(s, dt, steps, most, persistent);
      const auto rigids = on_host(s.rigids);
      const TimeCurve velocity{k_velocity.data(), 4, false}, gravity{k_gravity.data(), 4, false};
      const double travel = sum_of_means(velocity, CurveUse::value, 0, steps * dt, steps * dt);
      CHECK(std::fabs(rigids(0).motion.pose.displacement[1] - travel) < 1e-15);
      CHECK(std::fabs(on_host(s.timed.gravity)()[1] - gravity.value((steps + 0.5) * dt)) <
            B::of(1e-12, 1e-5));
      CHECK(std::fabs(rigids(1).force[1] - (-9e3 + 2 * gravity.value((steps + 0.5) * dt))) < 1e-9);
      CHECK((rigids(0).impulse[1] > 0 && rigids(1).impulse[1] > 0));  // the soil resists
    }
    const auto expected = soil_fields(states[0]);
    for (const int n : {1, 2}) {
      const auto fields = soil_fields(states[n]);
      if constexpr (is_device<typename B::Space>)  // the points of rigids come in any order
        CHECK(largest_difference(fields, expected) < B::of(1e-9, 1e-3));
      else
        CHECK(fields == expected);
    }
    if (states.size() > 3) CHECK(largest_difference(soil_fields(states[3]), expected) < B::of(1e-9, 1e-3));
  });
}

TEST_CASE("tables of one value give the same bits as the constants", "[time_tables]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(B::name());
    Cloud cloud = pressed_clay<B::dim>();
    cloud.gravity = {0, -9.81, 0};
    cloud.rigids[0].velocity = {0, -1.3, 0};
    auto constant = state_of<B>(cloud, P2G::tile), timed = state_of<B>(cloud, P2G::tile);
    const auto flat = [](double value) {
      return std::vector<CurvePoint>{{0, value}, {1e-3, value}, {9, value}};
    };
    upload_loads(timed, {load_of(LoadTarget::gravity, 0, 1, flat(-9.81)),
                         load_of(LoadTarget::velocity, 0, 1, flat(-1.3)),
                         load_of(LoadTarget::force, 1, 1, flat(-3e3))});
    timed_steps(constant, 1e-4, 40, 40, false);
    timed_steps(timed, 1e-4, 40, 9, false);
    CHECK(soil_fields(constant) == soil_fields(timed));
    CHECK(on_host(constant.rigids)(1).motion.pose.displacement[1] ==
          on_host(timed.rigids)(1).motion.pose.displacement[1]);
  });
}

TEST_CASE("tables are read from a line or a file, and their faults are reported", "[time_tables]") {
  const auto fault = [](const std::string& text, int dim = 2) {
    TableText read;
    return read_table(text, dim, 2, read);
  };
  TableText read;
  REQUIRE(read_table("0:1:2,0.5:3:4,2:-1e3:0", 2, 2, read).empty());
  CHECK((read.columns == 2 && read.table.times == std::vector<double>{0, 0.5, 2}));
  CHECK((read.table.values[1] == Vec3{3, 4, 0} && read.table.values[2][0] == -1000));
  TableText factors;
  REQUIRE(read_table("-1:0,3:1", 3, 2, factors).empty());
  CHECK((factors.columns == 1 && factors.table.values[1] == Vec3{1, 1, 1}));
  CHECK(fault("0:1:2").find("two points or more; there is one") == 0);
  CHECK(fault("0:1:2,0:1:2").find("times that increase; point 2 is at 0 s, after 0 s") == 0);
  CHECK(fault("0:1:2,1:1:2").find("a last point at the end of the run, 2 s, or later; it is at 1 s") == 0);
  CHECK(fault("1:1:2,3:1:2").find("a first point at 0 s or earlier") == 0);
  CHECK(fault("0:1:,3:1:2").find("a number in each place; number 3 of point 1 is missing") == 0);
  CHECK(fault("0:1:2,3:x:2").find("a number in each place; number 2 of point 2 is \"x\"") == 0);
  CHECK(fault("0:1:2,3:nan:2").find("a number in each place") == 0);
  CHECK(fault("0:1:2,3:1").find("as many numbers in each point; point 2 has 2, those before it 3") == 0);
  CHECK(fault("0:1:2:3,3:1:2:3").find("a time and 2 components, or a time and a factor") == 0);
  CHECK(fault("0:1:2,,3:1:2").find("a time and 2 components, or a time and a factor") == 0);
  CHECK(fault("no_such_file.csv").find("a file that") == 0);

  const auto path =
      std::filesystem::temp_directory_path() / ("mpm_table_" + std::to_string(::getpid()) + ".csv");
  const auto write = [&](const std::string& text) { std::ofstream(path) << text; };
  write("# a record\ntime, x, y\n0, 1,2\n\n 0.5,3,4 \r\n2,-1e3,0\n");
  TableText file;
  REQUIRE(read_table(path.string(), 2, 2, file).empty());
  CHECK((file.table.times == read.table.times && file.table.values == read.table.values));
  CHECK(file.table.file == path.string());
  write("time,x,y\n0,1,2\n1,,2\n2,1,2\n");
  CHECK(fault(path.string()).find("a number in each place; number 2 of line 3 is missing") == 0);
  write("time,x,y\n0,1,2\n1,1,2\n0.5,1,2\n");
  CHECK(fault(path.string()).find("times that increase; line 4 is at 0.5 s, after 1 s") == 0);
  write("");
  CHECK(fault(path.string()).find("two points or more; there is none") == 0);
  std::filesystem::remove(path);
}
