// Speed of a strategy, measured by a few steps.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include "run/autotune.hpp"
#include "run/strategy_choice.hpp"

using namespace mpm;

namespace {

/// A device whose batch takes 50 us and 10 us a step: none of them fails, and no rebuild is due.
PetscErrorCode advance(long steps, Batch* batch) {
  *batch = {};
  batch->steps = steps, batch->seconds = 50e-6 + 10e-6 * steps;
  return PETSC_SUCCESS;
}

}  // namespace

TEST_CASE("the autotune takes the time of a step from the largest batch", "[autotune]") {
  long largest = 0;
  const auto seconds = time_of_steps([&](long steps, Batch* batch) {
    largest = std::max(largest, steps);
    return advance(steps, batch);
  });
  REQUIRE(seconds);
  CHECK(largest == 128);
  CHECK(*seconds == Catch::Approx(10e-6 + 50e-6 / 128));
}

TEST_CASE("the autotune goes on where a device does not hold a launch of many steps", "[autotune]") {
  bool together = true;
  const auto seconds = time_of_steps([&](long steps, Batch* batch) {
    const bool ends = together && steps > 1;
    together = together && !ends;
    return advance(ends ? 1 : steps, batch);
  });
  REQUIRE(seconds);
  CHECK(*seconds == Catch::Approx(10e-6 + 50e-6 / 128));
}

TEST_CASE("the autotune ends at a rebuild, at a failure, and where time is up", "[autotune]") {
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

namespace {

/// Rounds of tile, gather, mosaic and atomic, in milliseconds.
std::vector<AutotuneTimes> rounds_of(std::vector<double> tile, std::vector<double> gather,
                                     std::vector<double> mosaic, std::vector<double> atomic) {
  std::vector<AutotuneTimes> candidates = {
      {P2G::tile, tile}, {P2G::gather, gather}, {P2G::mosaic, mosaic}, {P2G::atomic, atomic}};
  for (AutotuneTimes& candidate : candidates)
    for (double& seconds : candidate.seconds) seconds *= 1e-3;
  return candidates;
}

}  // namespace

TEST_CASE("the fastest strategy is taken and kept where its rounds agree", "[autotune]") {
  const auto tile =
      choose_by_times(rounds_of({10, 10.1, 10.2}, {14, 14, 15}, {12, 12, 13}, {20, 20, 20}), 0.5);
  CHECK(tile.strategy == P2G::tile);
  CHECK(tile.clear);
  const auto mosaic =
      choose_by_times(rounds_of({15, 15, 16}, {14, 14, 15}, {12, 12, 12.5}, {20, 20, 20}), 0.5);
  CHECK(mosaic.strategy == P2G::mosaic);
  CHECK(mosaic.clear);
}

TEST_CASE("a tie goes to tile, then to the earlier in the list", "[autotune]") {
  const auto tile =
      choose_by_times(rounds_of({12.5, 12.5, 12.5}, {14, 14, 14}, {12, 12, 12}, {20, 20, 20}), 0);
  CHECK(tile.strategy == P2G::tile);
  CHECK(tile.clear);
  const auto beyond =
      choose_by_times(rounds_of({12.7, 12.7, 12.7}, {14, 14, 14}, {12, 12, 12}, {20, 20, 20}), 0);
  CHECK(beyond.strategy == P2G::mosaic);
  CHECK(beyond.clear);
  const auto gather =
      choose_by_times(rounds_of({15, 15, 15}, {12.2, 12.2, 12.2}, {12, 12, 12}, {20, 20, 20}), 0);
  CHECK(gather.strategy == P2G::gather);
  CHECK(gather.clear);
}

TEST_CASE("one slow round changes nothing, as others may use the machine meanwhile", "[autotune]") {
  const auto choice =
      choose_by_times(rounds_of({15.5, 40, 15.6}, {18, 18, 90}, {19.5, 19.5, 19.6}, {30, 30, 30}), 0.5);
  CHECK(choice.strategy == P2G::tile);
  CHECK(choice.clear);
}

TEST_CASE("times of a busy machine are not kept", "[autotune]") {
  // Tile's true 15.5 ms were met once: it is taken, but most of its rounds would have said mosaic.
  const auto noisy =
      choose_by_times(rounds_of({31, 15.5, 29}, {40, 33, 36}, {19.5, 24, 19.8}, {30, 41, 50}), 0.5);
  CHECK(noisy.strategy == P2G::tile);
  CHECK(!noisy.clear);
  // Mosaic looks faster in its fastest round, but not in a typical one.
  const auto wrong =
      choose_by_times(rounds_of({25, 24, 26}, {40, 33, 36}, {19.5, 28, 27}, {30, 41, 50}), 0.5);
  CHECK(wrong.strategy == P2G::mosaic);
  CHECK(!wrong.clear);
  const auto steady = rounds_of({10, 10, 10}, {14, 14, 14}, {12, 12, 12}, {20, 20, 20});
  CHECK(choose_by_times(steady, k_busy).clear);
  const auto loaded = choose_by_times(steady, 1.01 * k_busy);
  CHECK(loaded.strategy == P2G::tile);
  CHECK(!loaded.clear);
}

TEST_CASE("a strategy that makes no step is left out; without any there is no choice", "[autotune]") {
  const auto choice = choose_by_times(rounds_of({}, {14, 14, 14}, {}, {20, 20, 20}), 0);
  CHECK(choice.strategy == P2G::gather);
  CHECK(choice.clear);
  const auto alone = choose_by_times(rounds_of({}, {}, {12, 50, 13}, {}), 0);
  CHECK(alone.strategy == P2G::mosaic);
  CHECK(alone.clear);  // there is no other
  CHECK(choose_by_times(rounds_of({}, {}, {}, {}), 0).strategy == P2G::automatic);
  CHECK(choose_by_times({}, 0).strategy == P2G::automatic);
}

TEST_CASE("what takes three times the fastest is tried once", "[autotune]") {
  const auto candidates = rounds_of({10, 12}, {31, 31}, {29, 29}, {});
  CHECK(!is_beaten(candidates[0], candidates));
  CHECK(is_beaten(candidates[1], candidates));
  CHECK(!is_beaten(candidates[2], candidates));
  CHECK(!is_beaten(candidates[3], candidates));  // it has not been tried
}

TEST_CASE("least and median of rounds", "[autotune]") {
  CHECK(least_of({}) == 0);
  CHECK(median_of({}) == 0);
  CHECK(least_of({3, 1, 2}) == 1);
  CHECK(median_of({9, 1, 2}) == 2);
  CHECK(median_of({4, 1, 2, 3}) == 3);  // the higher of two
}
