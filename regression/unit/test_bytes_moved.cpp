// Counts of the log's performance report: bytes that the functions must move, and the bandwidth of a copy.

#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"
#include "device/copy_bandwidth.hpp"
#include "step/bytes_moved.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Real numbers a particle, counted by hand, beside a cell (int) and a body (16 bits): to the nodes go place,
/// velocity, stress and volume; the update reads and writes place, velocity, stress, volume and plastic
/// strain, and reads the strength.
constexpr int k_to_nodes[] = {2 + 2 + 4 + 1, 3 + 3 + 6 + 1};
constexpr int k_update[] = {2 * (2 + 2 + 4 + 1 + 1) + 1, 2 * (3 + 3 + 6 + 1 + 1) + 1};

template <class B>
void check_bytes() {
  INFO(B::name());
  constexpr int at = B::dim - 2, real = sizeof(typename B::real);
  Cloud cloud;
  cloud.grid = grid_of<B::dim>({12, 12, 12}, 0.1, Wall::roller);
  cloud.materials = clays();
  cloud.bodies = {body_of<B::dim>(lattice<B::dim>({0, 0, 0}, {9, 9, 9}, 2, 0.1), 2, 0.1, 1)};
  const auto s = state_of<B>(cloud);
  const double particles = s.soil.points.count, nodes = s.patches.node_count();
  REQUIRE(particles == std::pow(18, B::dim));
  const double sums = nodes * real * (1 + 2 * B::dim), motion = nodes * real * 2 * B::dim;
  CHECK(bytes_of(StepPhase::reset, s) == sums);
  CHECK(bytes_of(StepPhase::nodes, s) == sums + motion);
  CHECK(bytes_of(StepPhase::soil_to_nodes, s) == particles * (k_to_nodes[at] * real + 4 + 2) + sums);
  CHECK(bytes_of(StepPhase::particles, s) == particles * (k_update[at] * real + 4 + 2) + motion);
  CHECK(bytes_of(StepPhase::rigid_to_nodes, s) == 0);
  CHECK(bytes_of(StepPhase::rigids, s) == 0);
}

template <class Space>
void check_copy() {
  INFO(Space::name());
  const double measured = copy_bandwidth(Space());
  CHECK(measured > 1e8);
  CHECK(measured < 1e14);
}

}  // namespace

TEST_CASE("the least bytes moved of a particle and a node are what is counted by hand", "[bytes_moved]") {
  for_each_build([](auto build) { check_bytes<decltype(build)>(); });
}

TEST_CASE("a copy has a bandwidth", "[bytes_moved]") {
  check_copy<Processor>();
  check_copy<Kokkos::DefaultExecutionSpace>();
}
