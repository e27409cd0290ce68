// Particles that are merged where soil that was split is pressed together.

#include <catch2/catch_test_macros.hpp>

#include <map>

#include "compare.hpp"
#include "physics/domain.hpp"
#include "rebuild/merge_particles.hpp"
#include "rebuild/shift_particle.hpp"
#include "rebuild/split_particles.hpp"
#include "split_soil.hpp"
#include "transfer/restore_state.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_dt = 1e-4;      // s
constexpr double k_spacing = 0.1;  // m

/// Two bodies whose particles fill a cell by 2 an edge and lie by 4, with velocities, stresses and strengths
/// of their own.
template <int Dim>
Cloud crowd(int seed) {
  Dice dice{std::mt19937_64(seed)};
  Cloud cloud = with_two_updates(seed);
  cloud.grid = grid_of<Dim>({12, 10, 6}, k_spacing, Wall::roller);
  for (const int material : {0, 1}) {
    const double from = material == 0 ? 1 : 5;
    cloud.bodies.push_back(
        body_of<Dim>(lattice<Dim>({from, 0, 1}, {from + 5, 6, 3}, 4, k_spacing), 2, k_spacing, material));
    give_own_state<Dim>(cloud.bodies.back(), dice);
  }
  cloud.stretch = cloud.split = true;
  return cloud;
}

/// Makes pieces of the particles of a state: by their ids, as light as an eighth and up to twice that, or
/// whole.
template <class S>
void make_pieces(S& s) {
  using T = typename decltype(s.soil.points.mass)::value_type;
  const auto points = s.soil.points;
  const auto id = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), points.id);
  const auto mass = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), points.mass);
  const auto volume = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), points.volume);
  const auto domain = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), points.domain);
  for (int p = 0; p < points.count; ++p) {
    const double share = id(p) % 16 == 0 ? 1 : k_least_piece * (1 + id(p) % 3 * 0.5);
    mass(p) = T(mass(p) * share), volume(p) = T(volume(p) * share);
    for (auto& moment : domain(p).c) moment = T(moment * (share == 1 ? 1 : 0.2 + id(p) % 5 * 0.02));
  }
  Kokkos::deep_copy(points.mass, mass), Kokkos::deep_copy(points.volume, volume);
  Kokkos::deep_copy(points.domain, domain);
}

template <class S>
void merge_all(S& s) {
  locate(s);
  merge_particles(s);
  sort_and_list(s);
}

/// Number of particles that merging has taken, and the kinetic energy [J] that went with them.
template <class S>
std::pair<int, double> merged(const S& s) {
  double count = 0, energy = 0;
  for (const Lost& lost : s.strays.lost) count += lost.merged, energy += lost.merged_energy;
  return {static_cast<int>(count), energy};
}

/// Sum over all particles of their mass times the moments of their domains and three times those of their
/// places, in units of cells.
template <int Dim, class S>
std::vector<double> moments_of(const S& s, const SoilFields& soil) {
  constexpr int width = Dim * (Dim + 1) / 2;
  const auto domain = on_host(s.soil.points.domain);
  const auto id = on_host(s.soil.points.id);
  std::map<int, int> place;  // of each particle, by its id
  for (int p = 0; p < s.soil.points.count; ++p) place[id(p)] = p;
  std::vector<double> sums(width);
  for (std::size_t p = 0; p < soil.id.size(); ++p)
    for (int i = 0; i < Dim; ++i)
      for (int j = i; j < Dim; ++j) {
        const int k = moment_index<Dim>(i, j);
        const double x = soil.position[p * Dim + i] / k_spacing, y = soil.position[p * Dim + j] / k_spacing;
        sums[k] += soil.mass[p] * (double(domain(place[soil.id[p]])[k]) + 3 * x * y);
      }
  return sums;
}

}  // namespace

TEST_CASE("merging keeps mass, volume, momentum, centre of mass, stress, state and moments of domains",
          "[merge_particles]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const int seed : {1, 2}) {
      auto s = state_of<B>(crowd<Dim>(seed), P2G::tile);
      make_pieces(s);
      const SoilFields before = download_soil(s);
      const std::vector<double> wide = moments_of<Dim>(s, before);
      const int start = s.soil.points.count;
      merge_all(s);
      const SoilFields after = download_soil(s);
      const auto [count, energy] = merged(s);
      INFO(B::name());
      REQUIRE(count > start / 10);
      CHECK(s.soil.points.count == start - count);
      const auto a = sums_of<Dim>(before), b = sums_of<Dim>(after);
      const std::size_t kept = a.size() - 2, kinetic = a.size() - 1;
      for (std::size_t k = 0; k < kept; ++k)
        CHECK(std::fabs(a[k] - b[k]) < B::of(1e-11, 1e-5) * (std::fabs(a[k]) + std::fabs(a[0])));
      CHECK(energy > 0);
      CHECK(std::fabs(a[kinetic] - b[kinetic] - energy) < B::of(1e-11, 1e-5) * a[kinetic]);
      const std::vector<double> now = moments_of<Dim>(s, after);
      for (std::size_t k = 0; k < wide.size(); ++k)
        CHECK(std::fabs(wide[k] - now[k]) < B::of(1e-11, 1e-5) * std::fabs(wide[0]));
    }
  });
}

TEST_CASE("merging stops where cells are not crowded, particles are whole, or domains would be long",
          "[merge_particles]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(B::name());
    auto whole = state_of<B>(crowd<Dim>(3));
    merge_all(whole);
    CHECK(merged(whole).first == 0);

    auto s = state_of<B>(crowd<Dim>(3));
    make_pieces(s);
    const double mass = download_soil(whole).mass[0];
    for (int n = 0; n < 3; ++n) merge_all(s);
    const SoilFields soil = download_soil(s);
    for (const double m : soil.mass) CHECK(m < mass * (1 + 2 * k_round_off));
    CHECK(merged(s).first > 0);
    CHECK(soil.id.size() >= download_soil(whole).id.size() / 8);  // at most half of a cell in each of three
    CHECK(find_splittings(s).empty());

    auto longer = state_of<B>(crowd<Dim>(3));
    make_pieces(longer);
    Kokkos::deep_copy(longer.soil.points.domain,
                      square_domain<typename B::real, Dim>(typename B::real(0.39)));
    merge_all(longer);
    CHECK(merged(longer).first == 0);
  });
}

TEST_CASE("cells that splitting has filled are not crowded", "[merge_particles]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = crowd<Dim>(2);
    for (BodyInput& body : cloud.bodies)
      body = body_of<Dim>(lattice<Dim>({2, 2, 2}, {6, 6, 4}, 2, k_spacing), 2, k_spacing, 0);
    cloud.bodies.resize(1);
    auto s = state_of<B>(cloud);
    const SoilFields before = download_soil(s);
    const int start = s.soil.points.count;
    auto longer = square_domain<typename B::real, Dim>(0.25);
    longer[0] = typename B::real(0.45 * 0.45);
    Kokkos::deep_copy(s.soil.points.domain, longer);
    locate(s);
    const auto splittings = find_splittings(s);
    std::vector<int> ids;
    for (std::size_t n = 0; n < splittings.size(); ++n) ids.push_back(start + static_cast<int>(n));
    split_particles(s, splittings, ids);
    sort_and_list(s);
    INFO(B::name());
    REQUIRE(s.soil.points.count == 2 * start);
    // Every cell holds twice as many as fill it.
    auto shorter = square_domain<typename B::real, Dim>(typename B::real(0.1));
    Kokkos::deep_copy(s.soil.points.domain, shorter);
    merge_all(s);
    CHECK(merged(s).first == 0);
  });
}

TEST_CASE("a run that has merged particles goes on from a saved state with the same bits",
          "[merge_particles]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = crowd<B::dim>(4);
    auto whole = state_of<B>(cloud, P2G::gather);
    make_pieces(whole);
    merge_all(whole);
    run_steps(whole, k_dt, 12);
    auto again = state_of<B>(cloud, P2G::gather);
    INFO(B::name());
    REQUIRE(restore_state(again, save_state(whole)).empty());
    CHECK(again.soil.points.count == whole.soil.points.count);
    CHECK(merged(again) == merged(whole));
    run_steps(whole, k_dt, 12), run_steps(again, k_dt, 12);
    CHECK(soil_fields(again) == soil_fields(whole));
    merge_all(whole), merge_all(again);
    CHECK(soil_fields(again) == soil_fields(whole));
  });
}
