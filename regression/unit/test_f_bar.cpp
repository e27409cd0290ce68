// F-bar where soil is of several materials: cells' means do not mix them, and each takes its own fraction.

#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "common/f_bar.hpp"
#include "compare.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_spacing = 0.1;

/// Two bodies of clay, with random velocities: in the same cells, or each in its own.
template <int Dim>
Cloud two_clays(bool same_cells) {
  Dice dice{std::mt19937_64(71)};
  Cloud cloud;
  cloud.grid = grid_of<Dim>({20, 12, 8}, k_spacing, Wall::free);
  cloud.materials = {clays()[1], clays()[1]};
  cloud.bodies = {random_body<Dim>(dice, {2, 2, 2}, {8, 8, 5}, 1, 3, k_spacing),
                  random_body<Dim>(dice, same_cells ? std::array{2, 2, 2} : std::array{11, 2, 2},
                                   same_cells ? std::array{8, 8, 5} : std::array{16, 8, 5}, 1, 2, k_spacing)};
  for (int b : {0, 1}) cloud.bodies[b].material = b;
  cloud.f_bar_fraction = 0.9;
  return cloud;
}

/// The growth of the volumes of a body's particles in one step, by id.
template <class B>
std::vector<double> growth(const Cloud& cloud, int of_body) {
  auto s = state_of<B>(cloud);
  const Table before = by_id(s.soil.points, s.soil.points.volume);
  one_step(s, 1e-5);
  const Table after = by_id(s.soil.points, s.soil.points.volume);
  std::vector<double> ratio;
  for (std::size_t p = 0, b = 0, end = 0; p < after.value.size(); ++p) {
    while (p == end) end += cloud.bodies[b++].position.size() / B::dim;
    if (static_cast<int>(b) - 1 == of_body) ratio.push_back(after.value[p] / before.value[p] - 1);
  }
  return ratio;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0, size = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    most = std::max(most, std::fabs(a[k] - b[k])), size = std::max(size, std::fabs(b[k]));
  return most / size;
}

}  // namespace

TEST_CASE("F-bar in cells of one material does not depend on other materials", "[f_bar]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const auto fields = [](bool same_cells, int second) {
      Cloud cloud = two_clays<B::dim>(same_cells);
      cloud.bodies[1].material = second;
      auto s = state_of<B>(cloud, is_device<typename B::Space> ? P2G::gather : P2G::sequential);
      CHECK(s.f_bar.by_material == (second == 1));
      run_steps(s, 1e-5, 20);
      return soil_fields(s);
    };
    INFO(build.name());
    // A device has another kernel for means by material, which may fuse other products and sums.
    if (is_device<typename B::Space>)
      CHECK(largest_difference(fields(false, 0), fields(false, 1)) < B::of(1e-11, 1e-4));
    else
      CHECK(fields(false, 0) == fields(false, 1));
    CHECK(largest_difference(fields(true, 0), fields(true, 1)) > 1e-6);  // the means do differ
  });
}

TEST_CASE("a material's fraction of F-bar is its own, with the mean of its own particles", "[f_bar]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = two_clays<B::dim>(true);
    for (BodyInput& body : cloud.bodies) body.stress.clear();  // the first velocities are then the same
    const auto with = [&](double fraction, double share, int of_body) {
      cloud.f_bar_fraction = fraction, cloud.materials[1].f_bar_share = share;
      return growth<B>(cloud, of_body);
    };
    const double round_off = B::of(1e-9, 2e-3);  // of a growth of some 1e-4
    INFO(build.name());
    for (const double share : {0., 0.5, 1.}) {
      CHECK(apart(with(0.9, share, 0), with(0.9, 1, 0)) < round_off);
      CHECK(apart(with(0.9, share, 1), with(0.9 * share, 1, 1)) < round_off);
    }
    CHECK(apart(with(0.9, 0, 1), with(0.9, 1, 1)) > 0.1);
  });
}

TEST_CASE("pressures begin alike within a material of a cell, as far as its fraction goes", "[f_bar]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = two_clays<B::dim>(true);
    const auto spread = [&](int material) {  // of pressures in cells, and of excess pore pressures [Pa]
      auto s = state_of<B>(cloud);
      const auto soil = s.soil.points;
      const auto cell = on_host(soil.cell);
      const auto body = on_host(soil.body);
      const auto stress = on_host(soil.stress);
      const auto excess = on_host(soil.history.column[soil.history.pore]);
      std::array<double, 2> most{};
      for (int p = 0; p < soil.count; ++p)
        for (int q = p + 1; q < soil.count && cell(q) == cell(p); ++q) {
          if (body(p) != material || body(q) != material) continue;
          most[0] = std::max(most[0], std::fabs(double(mean_of(stress(p))) - mean_of(stress(q))));
          most[1] = std::max(most[1], std::fabs(double(excess(p)) - excess(q)));
        }
      return most;
    };
    cloud.materials[0].pore_stiffness = 1e8;  // the other one drains
    Dice dice{std::mt19937_64(5)};
    std::vector<double> excess_p(cloud.bodies[0].position.size() / B::dim);
    for (double& pressure : excess_p) pressure = dice.uniform(0, 2000);
    give_excess_pressure<B::dim>(cloud.bodies[0], std::move(excess_p));
    cloud.f_bar_fraction = 1;
    INFO(build.name());
    const double round_off = B::of(1e-9, 1e-2);
    for (const double share : {0., 0.5, 1.}) {
      cloud.materials[1].f_bar_share = share;
      const auto wet = spread(0), dry = spread(1);
      CHECK((wet[0] < round_off && wet[1] < round_off && dry[1] == 0));
      cloud.f_bar_fraction = 0;
      const auto without = spread(1);
      cloud.f_bar_fraction = 1;
      CHECK(std::fabs(dry[0] - (1 - share) * without[0]) < round_off);
      CHECK(without[0] > 1000);
    }
  });
}

TEST_CASE("the fraction of F-bar of a material is its own, or else the run's", "[f_bar]") {
  Config config;
  config.f_bar_fraction = 0.9;
  CHECK((f_bar_range(config).least == 0.9 && f_bar_range(config).largest == 0.9));
  config.materials.resize(3);
  config.materials[1].f_bar_fraction = 0.2, config.materials[2].f_bar_fraction = 1;
  config.bodies.resize(2);
  config.bodies[1].material = 1;  // no body is of the third material
  CHECK(f_bar_fraction(config, config.materials[0]) == 0.9);
  CHECK((f_bar_range(config).least == 0.2 && f_bar_range(config).largest == 0.9));
  config.bodies[0].material = 1;
  CHECK((f_bar_range(config).least == 0.2 && f_bar_range(config).largest == 0.2));
}
