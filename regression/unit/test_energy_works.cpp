// The works of the energy balance.

#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <numbers>

#include "compare.hpp"
#include "rebuild/rebuild_state.hpp"
#include "transfer/measure.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double h = 0.1;

template <class Space, class T, int Dim>
std::vector<double> works_of(const State<Space, T, Dim>& s) {
  const auto host = on_host(s.energy.work);
  return {host.data(), host.data() + Work::count};
}

/// Kinetic energy that the nodes gain in a step [J], from their sums and motion.
template <class Space, class T, int Dim>
double gain_of_nodes(const State<Space, T, Dim>& s) {
  using S = SoilTerms<Dim>;
  const auto soil = on_host(s.nodes.soil);
  const auto motion = on_host(s.nodes.kinematics);
  double gain = 0;
  for (int i = 0; i < s.patches.node_count(); ++i) {
    const double m = soil(i, S::mass);
    if (!(m > 1e-12 * s.scheme.mass_cut)) continue;
    for (int d = 0; d < Dim; ++d) {
      const double before = soil(i, S::momentum + d) / m, v = motion(i, NodeKinematics<Dim>::velocity + d);
      gain += m * (v * v - before * before) / 2;
    }
  }
  return gain;
}

/// An elastic block in the middle of a free mesh, which vibrates along x.
template <int Dim>
Cloud vibrating_block() {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({16, 12, 8}, h, Wall::free);
  cloud.materials = clays();
  cloud.materials[0].parameters = {1.5e6, 0.3};
  const std::array<double, 3> low{4, 4, 3}, high{12, 8, 5};
  BodyInput body = body_of<Dim>(lattice<Dim>(low, high, 2, h), 2, h, 0);
  for (std::size_t p = 0; p < body.position.size() / Dim; ++p)
    for (int d = 0; d < Dim; ++d)
      body.velocity.push_back(d == 0 ? 0.5 * std::sin(std::numbers::pi * (body.position[p * Dim] / h - 8) / 8)
                                     : 0);
  cloud.bodies = {body};
  cloud.energy = true;
  return cloud;
}

struct Balance {
  double kinetic, stored, internal, error, update;  // J
};

/// The block after a quarter of its period, in steps of dt [s].
template <class B>
Balance balance_after(const Cloud& cloud, double dt, double end, P2G how = P2G::tile) {
  auto s = state_of<B>(cloud, how);
  const double start = measure(s, 0).kinetic_energy;
  run_steps(s, dt, static_cast<int>(std::lround(end / dt)));
  REQUIRE(read_control(s).fault_count == 0);
  const BodyMeasure now = measure(s, 0);
  const std::vector<double> work = works_of(s);
  return {now.kinetic_energy, now.stored_energy, work[Work::stress],
          work[Work::stress] + work[Work::internal],
          now.kinetic_energy - start - work[Work::internal] - work[Work::boundary]};
}

}  // namespace

TEST_CASE("the works at the nodes are what their kinetic energy gains: walls, contact, damping, gravity",
          "[energy_works]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const int seed : {1, 2}) {
      Cloud cloud = random_cloud<B::dim>(seed, seed == 1 ? Wall::roller : Wall::fixed);
      cloud.gravity = {1, -10, 3};
      cloud.damping = 0.3;
      cloud.energy = true;
      auto s = state_of<B>(cloud, P2G::gather);
      interpolate(s);
      update_nodes(s, 1e-4);
      add_node_works(s, 1e-4);
      const std::vector<double> work = works_of(s);
      double sum = 0, size = 0;
      for (const int k : {Work::internal, Work::gravity, Work::damping, Work::boundary})
        sum += work[k], size += std::fabs(work[k]);
      INFO(B::name() << " seed " << seed);
      for (const int k : {Work::internal, Work::gravity, Work::damping, Work::boundary})
        CHECK(std::fabs(work[k]) > 1e-4 * size);
      CHECK(work[Work::damping] < 0);
      CHECK(std::fabs(sum - gain_of_nodes(s)) < B::of(1e-12, 1e-5) * size);
    }
  });
}

TEST_CASE(
    "the work of the stress on an elastic block is its elastic energy, and what is missing falls with "
    "the time step",
    "[energy_works]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const double f_bar : {0.0, 0.9}) {
      Cloud cloud = vibrating_block<B::dim>();
      cloud.f_bar_fraction = f_bar;
      cloud.stretch = f_bar > 0;
      const Balance coarse = balance_after<B>(cloud, 4e-4, 0.008),
                    fine = balance_after<B>(cloud, 1e-4, 0.008);
      INFO(B::name() << " F-bar " << f_bar);
      CHECK(fine.stored > 0.2 * fine.kinetic);
      CHECK(std::fabs(fine.internal - fine.stored) < 0.01 * fine.stored);
      CHECK(std::fabs(fine.error) < 0.02 * fine.stored);
      CHECK(std::fabs(fine.error) < 0.6 * std::fabs(coarse.error) + B::of(0, 1e-3) * fine.stored);
      CHECK(std::fabs(fine.update) < 0.02 * fine.stored);
    }
  });
}

TEST_CASE("every strategy sums the same works", "[energy_works]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = vibrating_block<B::dim>();
    const Balance reference = balance_after<B>(cloud, 4e-4, 0.004, P2G::sequential);
    for (const P2G how : k_strategies) {
      const Balance other = balance_after<B>(cloud, 4e-4, 0.004, how);
      INFO(B::name() << ' ' << word_of(how));
      CHECK(std::fabs(other.internal - reference.internal) < B::of(1e-10, 1e-3) * reference.internal);
      CHECK(std::fabs(other.error - reference.error) < B::of(1e-10, 1e-3) * reference.internal);
    }
  });
}

TEST_CASE("gravity does m g h on a block that falls freely, and a rigid the force times its way",
          "[energy_works]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = vibrating_block<B::dim>();
    cloud.bodies[0].velocity.clear();
    cloud.bodies[0].common_velocity = {0.3, 0, 0};
    cloud.gravity = {0, -10, 0};
    auto s = state_of<B>(cloud, P2G::tile);
    const BodyMeasure before = measure(s, 0);
    run_steps(s, 4e-4, 250);
    const BodyMeasure now = measure(s, 0);
    const double fell = before.centre[1] - now.centre[1];
    INFO(B::name());
    CHECK(fell > 0.04);
    // Steps of dt fall by dt v / 2 more than is 0.5 g t^2: the work is with the mean of both velocities.
    CHECK(std::fabs(works_of(s)[Work::gravity] - (now.kinetic_energy - before.kinetic_energy)) <
          B::of(1e-12, 1e-4) * now.kinetic_energy);
    CHECK(std::fabs(works_of(s)[Work::gravity] - now.mass * 10 * fell) < 0.02 * now.kinetic_energy);

    Cloud pushed = vibrating_block<B::dim>();
    pushed.bodies[0].velocity.clear();
    pushed.rigids = {rigid_of<B::dim>(lattice<B::dim>({5, 8, 3}, {11, 9, 5}, 4, h), 4, h)};
    pushed.rigids[0].velocity = {0, -2, 0};
    auto p = state_of<B>(pushed, P2G::tile);
    run_steps(p, 1e-4, 60);
    const double impulse = take_rigids(p)[0].impulse[1];
    CHECK(impulse > 0);
    CHECK(std::fabs(works_of(p)[Work::rigids] - 2 * impulse) < 1e-9 * 2 * impulse);
  });
}

TEST_CASE("a rebuild keeps the works", "[energy_works]") {
  Cloud cloud = vibrating_block<2>();
  auto s = state_of<Reference<2>>(cloud, P2G::tile);
  run_steps(s, 4e-4, 3);
  const std::vector<double> before = works_of(s);
  CHECK(before[Work::stress] > 0);
  rebuild(s);
  CHECK(works_of(s) == before);
}
