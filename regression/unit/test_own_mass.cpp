// Particles with masses of their own: every strategy, sum and copy takes them.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "functions/velocity_update.hpp"
#include "rebuild/batches.hpp"
#include "transfer/measure.hpp"
#include "transfer/restore_state.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_dt = 1e-4;  // s

/// Two bodies side by side that move and strain, of which each particle has a mass at most this share from
/// the common one. No node holds next to nothing: round-off stays what it is.
template <int Dim>
Cloud cloud_with_masses(int seed, double spread) {
  constexpr double k_spacing = 0.1;  // m
  Dice dice{std::mt19937_64(seed)};
  Cloud cloud;
  cloud.grid = grid_of<Dim>({18, 12, 9}, k_spacing, Wall::roller);
  cloud.materials = clays();
  cloud.gravity = {0, -10, -5};
  cloud.f_bar_fraction = 0.9;
  for (const int n : {2, 3}) {
    const double from = n == 2 ? 2 : 8;
    cloud.bodies.push_back(
        body_of<Dim>(lattice<Dim>({from, 2, 2}, {from + 6, 10, 6}, n, k_spacing), n, k_spacing, n - 2));
    BodyInput& body = cloud.bodies.back();
    for (std::size_t k = 0; k < body.position.size(); ++k) body.velocity.push_back(dice.uniform(-1, 1));
    for (std::size_t k = 0; k < strength_of(body).size() * sym_size<Dim>; ++k)
      body.stress.push_back(dice.uniform(-300, 300));
  }
  give_own_masses(cloud, seed, spread);
  return cloud;
}

/// Bodies of the cloud with one mass each.
Cloud without_masses(Cloud cloud) {
  for (BodyInput& body : cloud.bodies) body.mass.clear(), body.least_mass = 0;
  return cloud;
}

/// The velocity updates, which load particles each in their own way.
void choose_update(Cloud& cloud, int kind) {
  if (kind == 1) cloud.xpic_order = 3, cloud.flip_fraction = 0;
  if (kind == 2) cloud.affine = true, cloud.flip_fraction = 0;
}

std::vector<double> all_masses(const Cloud& cloud) {
  std::vector<double> masses;
  for (const BodyInput& body : cloud.bodies) masses.insert(masses.end(), body.mass.begin(), body.mass.end());
  return masses;
}

}  // namespace

TEST_CASE("own masses that are all alike give what one mass a body gives", "[own_mass]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const P2G how : k_strategies)
      for (const int kind : {0, 1, 2}) {
        Cloud cloud = cloud_with_masses<B::dim>(3, 0);
        choose_update(cloud, kind);
        auto own = state_of<B>(cloud, how), common = state_of<B>(without_masses(cloud), how);
        INFO(B::name() << " " << word_of(how) << ", velocity update " << kind);
        CHECK(own.soil.points.has_own_mass);
        CHECK(common.soil.points.mass.extent(0) == 0);
        CHECK(own.scheme.mass_cut == common.scheme.mass_cut);
        run_steps(own, k_dt, 6), run_steps(common, k_dt, 6);
        const bool ordered = B::backend() == Backend::serial;
        CHECK(largest_difference(soil_fields(own), soil_fields(common)) <=
              (ordered ? 0 : B::of(1e-11, 2e-2)));
      }
  });
}

TEST_CASE("every strategy gives the nodes the masses that the particles have", "[own_mass]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = cloud_with_masses<B::dim>(4, 0.6);
    auto plain = state_of<Reference<B::dim>>(cloud);
    interpolate(plain);
    double mass = 0, expected = 0;
    for (const double m : all_masses(cloud)) expected += m;
    const Table nodes = nodes_of(plain, plain.nodes.soil);
    for (std::size_t n = 0; n < nodes.value.size(); n += nodes.width) mass += nodes.value[n];
    CHECK(std::fabs(mass / expected - 1) < 1e-13);
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(cloud, how);
      interpolate(s);
      INFO(B::name() << " " << word_of(how));
      CHECK(largest_difference(nodes_of(s, s.nodes.soil), nodes) < B::of(1e-12, 1e-4));
    }
  });
}

TEST_CASE("steps with own masses are those of the plain loop, and at once those of each function apart",
          "[own_mass]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const int kind : {0, 1, 2}) {
      Cloud cloud = cloud_with_masses<B::dim>(6, 0.6);
      choose_update(cloud, kind);
      auto plain = state_of<Reference<B::dim>>(cloud);
      auto without = state_of<Reference<B::dim>>(without_masses(cloud));
      run_steps(plain, k_dt, 6), run_steps(without, k_dt, 6);
      CHECK(largest_difference(soil_fields(plain), soil_fields(without)) > 1e-6);  // they matter
      for (const P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        run_steps(s, k_dt, 6);
        INFO(B::name() << " " << word_of(how) << ", velocity update " << kind);
        CHECK(largest_difference(soil_fields(s), soil_fields(plain)) < B::of(1e-10, 2e-2));
      }
    }
  });
}

TEST_CASE("mass, momentum, energy and centre of a body are sums over its particles' masses", "[own_mass]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const Cloud cloud = cloud_with_masses<Dim>(5, 0.6);
    const auto s = state_of<B>(cloud);
    for (int b = 0; b < static_cast<int>(cloud.bodies.size()); ++b) {
      const BodyInput& body = cloud.bodies[b];
      double mass = 0, energy = 0, momentum[3] = {}, centre[3] = {}, size = 0;
      for (std::size_t p = 0; p < body.mass.size(); ++p) {
        mass += body.mass[p];
        for (int d = 0; d < Dim; ++d) {
          const double v = body.velocity[p * Dim + d];
          momentum[d] += body.mass[p] * v, energy += body.mass[p] * v * v / 2,
              size += body.mass[p] * std::fabs(v);
          centre[d] += body.mass[p] * body.position[p * Dim + d];
        }
      }
      const BodyMeasure m = measure(s, b);
      INFO(build.name() << " body " << b);
      CHECK(std::fabs(m.mass / mass - 1) < B::of(1e-13, 1e-6));
      CHECK(std::fabs(m.kinetic_energy / energy - 1) < B::of(1e-12, 1e-5));
      for (int d = 0; d < Dim; ++d) {
        CHECK(std::fabs(m.momentum[d] - momentum[d]) < B::of(1e-13, 1e-6) * size);
        CHECK(std::fabs(m.centre[d] / (centre[d] / mass) - 1) < B::of(1e-12, 1e-5));
      }
    }
  });
}

TEST_CASE("own masses are saved, restored and reported by id, whatever was sorted in between", "[own_mass]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = cloud_with_masses<B::dim>(7, 0.6);
    auto s = state_of<B>(cloud, P2G::tile);
    run_steps(s, k_dt, 5);
    rebuild(s);
    std::vector<double> expected = all_masses(cloud);
    for (double& m : expected) m = static_cast<typename B::real>(m);
    INFO(B::name());
    CHECK(download_soil(s).mass == expected);
    auto again = state_of<B>(cloud, P2G::tile);
    Kokkos::deep_copy(again.soil.points.mass, typename B::real(1));
    REQUIRE(restore_state(again, save_state(s)).empty());
    CHECK(download_soil(again).mass == expected);
    const std::vector<double> common = download_soil(state_of<B>(without_masses(cloud))).mass;
    for (std::size_t p = 0; p < common.size(); p += 7) {
      std::size_t b = 0, first = 0;
      while (p >= first + strength_of(cloud.bodies[b]).size()) first += strength_of(cloud.bodies[b++]).size();
      CHECK(common[p] ==
            static_cast<typename B::real>(cloud.bodies[b].density * cloud.bodies[b].particle_volume));
    }
  });
}

TEST_CASE("batches carry own masses", "[own_mass]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    Cloud cloud = cloud_with_masses<B::dim>(8, 0);
    const double spacing = cloud.grid.spacing;
    const auto& cells = cloud.grid.cells;
    cloud.bodies = {body_of<B::dim>(
        lattice<B::dim>({1, 1, 1}, {cells[0] - 1.0, cells[1] - 1.0, cells[2] - 1.0}, 2, spacing), 2, spacing,
        0)};
    give_own_masses(cloud, 8, 0.6);
    auto whole = state_of<B>(cloud, P2G::tile);
    cloud.memory_limit = 1;
    cloud.memory_limit = state_of<B>(cloud, P2G::tile).batches.least;
    auto parts = state_of<B>(cloud, P2G::tile);
    REQUIRE(parts.batches.all.size() > 3);
    run_steps(whole, k_dt, 5), run_steps(parts, k_dt, 5);
    collect_soil(parts);
    CHECK(largest_difference(soil_fields(parts), soil_fields(whole)) == 0);
  });
}
