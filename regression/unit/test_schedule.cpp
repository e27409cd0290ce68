#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "step/schedule.hpp"

using namespace mpm;

namespace {

/// Steps that it takes, step by step.
double counted(double left, double increment, double growth) {
  double moved = 0, steps = 0;
  for (; moved < left; ++steps) moved += increment, increment += growth;
  return steps;
}

}  // namespace

TEST_CASE("the steps to a rebuild are those of soil at a steady speed, or with a steady acceleration",
          "[schedule]") {
  for (const double increment : {1e-5, 1e-4, 3e-3})
    for (const double growth : {0.0, 1e-7, 2e-6, 1e-4}) {
      const double steps = steps_to_move(0.25, increment, growth);
      CHECK(std::fabs(steps - counted(0.25, increment, growth)) <= 2);
    }
}

TEST_CASE("soil that slows down is taken as steady, and no margin that is left as no step", "[schedule]") {
  CHECK(steps_to_move(0.25, 1e-3, -1e-4) == steps_to_move(0.25, 1e-3, 0));
  CHECK(steps_to_move(0, 1e-3, 0) == 0);
  CHECK(steps_to_move(-1, 1e-3, 1) == 0);
  CHECK(std::isfinite(steps_to_move(0.25, 0, 0)));
}

TEST_CASE("looks for rasters are due at their interval, and steps stop there", "[schedule]") {
  TimeConfig time;
  time.end = 1;
  OutputConfig output;
  output.interval = output.history_interval = 10;
  CHECK_FALSE(Schedule(time, output, 0.1).raster_in_turn(3));
  output.raster_interval = 0.3;
  const Schedule schedule(time, output, 0.1);
  for (long step = 0; step <= 10; ++step) CHECK(schedule.raster_in_turn(step) == (step > 0 && step % 3 == 0));
  CHECK(schedule.next_stop(0) == 3);
  CHECK(schedule.next_stop(3) == 6);
  CHECK(schedule.next_stop(9) == 10);
}
