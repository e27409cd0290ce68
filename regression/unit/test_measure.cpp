// Values of particles and nodes in the history and the frames.

#include <algorithm>
#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "functions/grid_velocity.hpp"
#include "transfer/measure.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The coordinates along d of one body's particles [m], sorted.
std::vector<double> sorted_coordinates(const std::vector<double>& position, const Cloud& cloud, int body,
                                       int d, int dim) {
  std::size_t from = 0;
  for (int b = 0; b < body; ++b) from += strength_of(cloud.bodies[b]).size();
  std::vector<double> x;
  for (std::size_t p = from; p < from + strength_of(cloud.bodies[body]).size(); ++p)
    x.push_back(position[p * dim + d]);
  std::sort(x.begin(), x.end());
  return x;
}

/// Two bodies on which nothing acts, with no stress, and more than a cell away from the mesh's sides.
template <int Dim>
Cloud free_cloud(int seed) {
  Cloud cloud = random_cloud<Dim>(seed);
  cloud.rigids.clear();
  Dice dice{std::mt19937_64(seed)};
  cloud.bodies = {cloud.bodies[2], random_body<Dim>(dice, {4, 4, 2}, {8, 8, 5}, 0.6, 2, cloud.grid.spacing)};
  for (BodyInput& body : cloud.bodies) body.stress.clear();
  return cloud;
}

template <class S>
Table grid_velocity_table(S& s, int dim) {
  sum_present_soil(s);
  return {dim, grid_velocities(s, order_for_host(s))};
}

}  // namespace

TEST_CASE("quantiles, extent and centre of mass of a body are those of its sorted particles", "[measure]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const Cloud cloud = random_cloud<Dim>(5);
    auto s = state_of<B>(cloud);
    drift_within_margin(s);
    const auto position = download_soil(s).position;
    for (int body = 0; body < static_cast<int>(cloud.bodies.size()); ++body) {
      const BodyMeasure m = measure(s, body);
      for (int d = 0; d < Dim; ++d) {
        INFO(build.name() << " body " << body << " direction " << d);
        const auto x = sorted_coordinates(position, cloud, body, d, Dim);
        const long n = static_cast<long>(x.size());
        REQUIRE(m.count == n);
        const double size = x.back() - x.front(), near = 1e-14 * x.back();
        CHECK(std::fabs(m.lower[d] - x.front()) <= near);
        CHECK(std::fabs(m.upper[d] - x.back()) <= near);
        double sum = 0;
        for (double each : x) sum += each;
        CHECK(std::fabs(m.centre[d] - sum / n) < 1e-13 * x.back());
        for (long rank : {1L, n / 3, n - n / 10, n - n / 1000, n}) {
          const double got = ranked_coordinate(s, body, d, rank, m);
          CHECK(got >= x[rank - 1] - near);
          CHECK(got <= x[rank - 1] + 0x1p-24 * size + near);
        }
      }
    }
  });
}

TEST_CASE("a body of equal coordinates has that one as every quantile", "[measure]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    Cloud cloud;
    cloud.grid = grid_of<Dim>({8, 8, 8}, 0.1, Wall::free);
    cloud.materials = clays();
    cloud.bodies = {body_of<Dim>(lattice<Dim>({2, 3, 2}, {3, 4, 3}, 1, 0.1), 1, 0.1, 0)};
    auto s = state_of<B>(cloud);
    const BodyMeasure m = measure(s, 0);
    REQUIRE(m.count == 1);
    CHECK(std::fabs(ranked_coordinate(s, 0, 1, 1, m) - 0.35) < 1e-7);
  });
}

TEST_CASE("the grid velocity at a particle is the one that a PIC step gives it", "[measure]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = free_cloud<Dim>(6);
    cloud.flip_fraction = 0;
    for (P2G how : k_strategies)
      for (bool rebuilt : {false, true}) {
        auto s = state_of<B>(cloud, how);
        INFO(build.name() << ' ' << word_of(how) << (rebuilt ? " just rebuilt" : " drifted"));
        drift_within_margin(s);
        if (rebuilt) rebuild(s);
        const Table seen = grid_velocity_table(s, Dim);
        one_step(s, 1e-9);
        REQUIRE(read_control(s).fault_count == 0);
        CHECK(largest_difference(seen, {Dim, download_soil(s).velocity}) < B::of(1e-12, 1e-5));
      }
  });
}

TEST_CASE("the grid of a body that moves as a whole has its velocity", "[measure]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    Cloud cloud = free_cloud<Dim>(7);
    for (BodyInput& body : cloud.bodies) body.velocity.clear(), body.common_velocity = {3, -4, 12};
    auto s = state_of<B>(cloud);
    drift_within_margin(s);
    Table expected{Dim, {}};
    for (int p = 0; p < s.soil.points.count; ++p)
      for (int d = 0; d < Dim; ++d) expected.value.push_back(cloud.bodies[0].common_velocity[d]);
    CHECK(largest_difference(grid_velocity_table(s, Dim), expected) < B::of(1e-14, 1e-6));
    CHECK(std::fabs(largest_grid_speed(s, 0) / (Dim == 2 ? 5 : 13) - 1) < B::of(1e-14, 1e-6));
  });
}

TEST_CASE("the largest grid speed of a body is that of its particles", "[measure]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const Cloud cloud = random_cloud<Dim>(8);
    auto s = state_of<B>(cloud);
    const auto velocity = grid_velocity_table(s, Dim).value;
    std::size_t p = 0;
    for (int body = 0; body < static_cast<int>(cloud.bodies.size()); ++body) {
      INFO(build.name() << " body " << body);
      double fastest = 0;
      for (const std::size_t end = p + strength_of(cloud.bodies[body]).size(); p < end; ++p) {
        double square = 0;
        for (int d = 0; d < Dim; ++d) square += velocity[p * Dim + d] * velocity[p * Dim + d];
        fastest = std::max(fastest, std::sqrt(square));
      }
      CHECK(std::fabs(largest_grid_speed(s, body) / fastest - 1) < 1e-13);
    }
  });
}

TEST_CASE("measuring between steps leaves every bit of the run", "[measure]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = random_cloud<Dim>(9, Wall::roller);
    cloud.p2g.margin = 0.02;
    const auto fields_after = [&](P2G how, bool watched) {
      auto s = state_of<B>(cloud, how);
      for (int n = 0; n < 20; ++n) {
        run_steps(s, 2e-5, 1);
        if (!watched) continue;
        const BodyMeasure m = measure(s, 0);
        ranked_coordinate(s, 0, 0, m.count, m);
        grid_velocity_table(s, Dim);
        largest_grid_speed(s, 0);
      }
      REQUIRE(read_control(s).fault_count == 0);
      return soil_fields(s);
    };
    for (P2G how : {P2G::gather, P2G::mosaic}) {
      INFO(build.name() << ' ' << word_of(how));
      CHECK(fields_after(how, true) == fields_after(how, false));
    }
  });
}
