// The clocks of the performance report.

#include <catch2/catch_test_macros.hpp>

#include <chrono>
#include <thread>

#include "step/timers.hpp"

using namespace mpm;

TEST_CASE("whole steps are timed where they are many, and again a thousand later", "[timers]") {
  Timers timers;
  REQUIRE(timers.create() == PETSC_SUCCESS);
  int waits = 0;
  const auto run = [&](long steps) {
    const auto work = [&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return steps;
    };
    REQUIRE(timers.run_many(StepPhase::persistent, steps, work, [&] { ++waits; }) == PETSC_SUCCESS);
  };
  run(3);
  CHECK(waits == 0);
  CHECK(timers.calls(StepPhase::persistent) == 3);
  CHECK(timers.seconds(StepPhase::persistent) == 0);
  run(500);
  CHECK(waits == 2);  // for what was before, and for the steps
  const double first = timers.seconds(StepPhase::persistent);
  CHECK(first >= 0.002 * 503 / 500);
  run(500);
  CHECK(waits == 2);
  CHECK(timers.calls(StepPhase::persistent) == 1003);
  CHECK(timers.seconds(StepPhase::persistent) > 1.9 * first);
  run(600), run(100);
  CHECK(waits == 4);  // of the second one alone
}
