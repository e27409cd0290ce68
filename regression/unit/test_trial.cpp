// What a few steps tell of a strategy's speed.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include "trial.hpp"

using namespace mpm;

namespace {

/// A device whose batch takes 50 us and 10 us a step: none of them fails, and no rebuild is due.
PetscErrorCode advance(long steps, Batch* batch) {
  *batch = {};
  batch->steps = steps, batch->seconds = 50e-6 + 10e-6 * steps;
  return PETSC_SUCCESS;
}

}  // namespace

TEST_CASE("a trial takes the time of a step from the largest batch", "[trial]") {
  long largest = 0;
  const auto seconds = time_of_steps([&](long steps, Batch* batch) {
    largest = std::max(largest, steps);
    return advance(steps, batch);
  });
  REQUIRE(seconds);
  CHECK(largest == 128);
  CHECK(*seconds == Catch::Approx(10e-6 + 50e-6 / 128));
}

TEST_CASE("a trial goes on where a device does not hold a launch of many steps", "[trial]") {
  bool together = true;
  const auto seconds = time_of_steps([&](long steps, Batch* batch) {
    const bool ends = together && steps > 1;
    together = together && !ends;
    return advance(ends ? 1 : steps, batch);
  });
  REQUIRE(seconds);
  CHECK(*seconds == Catch::Approx(10e-6 + 50e-6 / 128));
}

TEST_CASE("a trial ends at a rebuild, at a failure, and where time is up", "[trial]") {
  long done = 0;
  const auto until = [&](long last, auto&& how) {
    return [&done, last, how](long steps, Batch* batch) {
      const long takes = std::min(steps, last - done);
      done += takes;
      const PetscErrorCode error = advance(takes, batch);
      if (done == last) how(*batch);
      return error;
    };
  };
  const auto due = time_of_steps(until(7, [](Batch& batch) { batch.rebuild = true; }));
  REQUIRE(due);  // after batches of 2, 1 and 2 steps
  CHECK(*due == Catch::Approx(10e-6 + 50e-6 / 2));
  CHECK(done == 7);
  done = 0;
  CHECK(!time_of_steps(until(2, [](Batch& batch) { batch.failure.what = "a particle left the mesh"; })));
  CHECK(done == 2);
  CHECK(!time_of_steps([](long, Batch*) { return PETSC_ERR_MEM; }));
  int batches = 0;
  const auto slow = time_of_steps([&](long steps, Batch* batch) {
    ++batches;
    batch->steps = steps, batch->seconds = 1;
    return PETSC_SUCCESS;
  });
  REQUIRE(slow);
  CHECK(*slow == 1);
  CHECK(batches == 2);
}
