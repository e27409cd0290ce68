// Particles that are split where soil is stretched far.

#include <catch2/catch_test_macros.hpp>

#include <set>

#include "compare.hpp"
#include "physics/domain.hpp"
#include "rebuild/shift_particle.hpp"
#include "rebuild/split_particles.hpp"
#include "split_soil.hpp"
#include "transfer/restore_state.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_dt = 1e-4;      // s
constexpr double k_spacing = 0.1;  // m

/// Two bodies with two particles a cell along an edge, of which every other one is missing; domains of all
/// lengths and directions, some of which are long enough to split.
template <int Dim>
Cloud cloud_to_split(int seed) {
  Dice dice{std::mt19937_64(seed)};
  Cloud cloud = with_two_updates(seed);
  cloud.grid = grid_of<Dim>({18, 12, 9}, k_spacing, Wall::roller);
  for (const int material : {0, 1}) {
    const double from = material == 0 ? 1 : 9;
    const auto all = lattice<Dim>({from, 0, 1}, {from + 8, 10, 8}, 2, k_spacing);
    std::vector<double> some;
    for (std::size_t p = 0; p < all.size() / Dim; ++p)
      if (dice.below(2)) some.insert(some.end(), all.begin() + p * Dim, all.begin() + (p + 1) * Dim);
    cloud.bodies.push_back(body_of<Dim>(some, 2, k_spacing, material));
    give_own_state<Dim>(cloud.bodies.back(), dice);
  }
  give_own_domains<Dim>(cloud, seed);
  cloud.split = true;
  return cloud;
}

/// Splits what is to be split, as a run does, and sorts. Returns the number of new particles.
template <class S>
int split_all(S& s, int next_id) {
  locate(s);
  const auto splittings = find_splittings(s);
  std::vector<int> ids;
  for (std::size_t n = 0; n < splittings.size(); ++n) ids.push_back(next_id + static_cast<int>(n));
  split_particles(s, splittings, ids);
  sort_and_list(s);
  return static_cast<int>(ids.size());
}

}  // namespace

TEST_CASE(
    "splitting keeps mass, momentum, angular momentum, energy, stress and state, and the moments of domains",
    "[split_particles]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const int seed : {1, 2}) {
      auto s = state_of<B>(cloud_to_split<Dim>(seed), P2G::tile);
      const SoilFields before = download_soil(s);
      const Table moments = by_id(s.soil.points, s.soil.points.domain);
      const int start = s.soil.points.count, more = split_all(s, start);
      const SoilFields after = download_soil(s);
      INFO(B::name());
      REQUIRE(more > 20);
      REQUIRE(s.soil.points.count == start + more);
      const auto a = sums_of<Dim>(before), b = sums_of<Dim>(after);
      for (std::size_t k = 0; k < a.size(); ++k)
        CHECK(std::fabs(a[k] - b[k]) < B::of(1e-12, 1e-5) * (std::fabs(a[k]) + std::fabs(a[0])));
      CHECK(std::set<int>(after.id.begin(), after.id.end()).size() == after.id.size());

      // The two halves of each: their moments and those of their centres are those of the whole.
      std::vector<std::vector<std::size_t>> of(start);
      for (std::size_t p = 0; p < after.id.size(); ++p) of[std::size_t(after.ancestor[p])].push_back(p);
      const Table halves = by_id(s.soil.points, s.soil.points.domain);
      int split = 0, kept = 0;
      for (int whole = 0; whole < start; ++whole) {
        const std::size_t p = of[whole][0];
        if (of[whole].size() == 1) continue;
        REQUIRE(of[whole].size() == 2);
        ++split;
        const std::size_t q = of[whole][1];
        CHECK(after.mass[p] == after.mass[q]);
        double apart[Dim];
        for (int d = 0; d < Dim; ++d) {
          apart[d] = (after.position[p * Dim + d] - after.position[q * Dim + d]) / 2 / k_spacing;
          CHECK(after.velocity[p * Dim + d] == after.velocity[q * Dim + d]);
        }
        double length = 0;
        for (const double x : apart) length += x * x;
        // At a side of the mesh they are nearer together, and of those beyond half a cell some is forgotten.
        const bool inside = length > 0.19 * 0.19 && length < 0.2499 * 0.2499;
        kept += inside;
        for (int i = 0; i < Dim && inside; ++i)
          for (int j = i; j < Dim; ++j) {
            const int k = moment_index<Dim>(i, j), width = Dim * (Dim + 1) / 2;
            CHECK(std::fabs(halves.value[std::size_t(after.id[p]) * width + k] + 3 * apart[i] * apart[j] -
                            moments.value[std::size_t(whole) * width + k]) < B::of(1e-12, 1e-5));
          }
      }
      CHECK(split == more);
      CHECK(kept > more / 4);
    }
  });
}

TEST_CASE("particles are split until they are an eighth, and not where cells are full", "[split_particles]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud;
    cloud.grid = grid_of<Dim>({12, 12, 12}, k_spacing, Wall::roller);
    cloud.materials = clays();
    cloud.split = cloud.stretch = true;
    cloud.bodies = {body_of<Dim>(lattice<Dim>({3, 3, 3}, {9, 9, 9}, 1, k_spacing), 2, k_spacing, 0)};
    const std::size_t start = strength_of(cloud.bodies[0]).size();
    auto s = state_of<B>(cloud);
    INFO(B::name());
    auto longer = square_domain<typename B::real, Dim>(0.25);
    longer[0] = 0.25;
    int all = static_cast<int>(start);
    for (int n = 0; n < 8; ++n) {
      Kokkos::deep_copy(s.soil.points.domain, longer);  // stretched to half a cell again
      all += split_all(s, all);
    }
    const SoilFields soil = download_soil(s);
    const double whole = cloud.bodies[0].density * cloud.bodies[0].particle_volume;
    double least = whole, mass = 0;
    for (const double m : soil.mass) least = std::min(least, m), mass += m;
    CHECK(std::fabs(least / whole - k_least_piece) < 1e-6);
    CHECK(std::fabs(mass / (whole * start) - 1) < B::of(1e-12, 1e-5));

    cloud.bodies = {body_of<Dim>(lattice<Dim>({3, 3, 3}, {9, 9, 9}, 3, k_spacing), 2, k_spacing, 0)};
    for (std::size_t p = 0; p < strength_of(cloud.bodies[0]).size(); ++p) {
      auto m = square_domain<double, Dim>(0.45);
      cloud.bodies[0].domain.insert(cloud.bodies[0].domain.end(), m.c, m.c + Dim * (Dim + 1) / 2);
    }
    auto full = state_of<B>(cloud);
    locate(full);
    CHECK(find_splittings(full).empty());
  });
}

TEST_CASE("a run that has split particles goes on from a saved state with the same bits",
          "[split_particles]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = cloud_to_split<B::dim>(4);
    auto whole = state_of<B>(cloud, P2G::gather);
    const int start = whole.soil.points.count, more = split_all(whole, start);
    run_steps(whole, k_dt, 12);
    auto again = state_of<B>(cloud, P2G::gather);
    INFO(B::name());
    REQUIRE(restore_state(again, save_state(whole)).empty());
    CHECK(again.soil.points.count == start + more);
    run_steps(whole, k_dt, 12), run_steps(again, k_dt, 12);
    CHECK(soil_fields(again) == soil_fields(whole));
    CHECK(split_all(again, start + more) == split_all(whole, start + more));
    CHECK(soil_fields(again) == soil_fields(whole));
  });
}
