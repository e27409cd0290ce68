// Water that flows in pores: the solve of a node, limits of its drag, the fast wave.

#include <algorithm>
#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "compare.hpp"
#include "physics/pore_flow.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A node of saturated soil of random porosity and densities, with a drag of any size.
FlowNode random_node(Dice& dice) {
  const double n = dice.uniform(0.05, 0.95), water = 1000, grains = dice.uniform(1100, 3000);
  const double volume = std::pow(10, dice.uniform(-6, 2)), drag = std::pow(10, dice.uniform(-6, 8));
  return {((1 - n) * grains + n * water) * volume, water * volume, water / n * volume + drag * volume,
          dice.uniform(-1, 1) * volume, dice.uniform(-1, 1) * volume};
}

constexpr int k_cells = 20;                     // of the column
constexpr double k_height = 1, k_speed = 1e-4;  // m, m/s

/// A saturated column between rollers, along the last axis, whose grains begin with a sine of velocity; set
/// A.
template <int Dim>
Cloud column(double permeability) {
  constexpr double d = k_height / k_cells;
  Cloud cloud;
  std::array<int, 3> cells{2, 2, 2};
  cells[Dim - 1] = k_cells;
  cloud.grid = grid_of<Dim>(cells, d, Wall::roller);
  cloud.materials = clays();
  cloud.materials[0].parameters = {10e6, 0.25}, cloud.materials[0].saturated = true;
  std::array<double, 3> high{2, 2, 2};
  high[Dim - 1] = k_cells;
  cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, high, 2, d), 2, d, 0)};
  BodyInput& body = cloud.bodies[0];
  body.state.clear();
  body.density = 1990;
  body.solid_volume.assign(body.position.size() / Dim, 0.6 * body.particle_volume);
  for (std::size_t p = 0; p < body.position.size(); p += Dim)
    for (int k = 0; k < Dim; ++k)
      body.velocity.push_back(
          k < Dim - 1 ? 0 : k_speed * std::sin(std::numbers::pi * body.position[p + k] / k_height));
  cloud.f_bar_fraction = 0.98;
  cloud.flow.pores = {Pores{true, 0.4, 2650, permeability, false}, Pores{}};
  cloud.flow.water = {.density = 1000, .bulk_modulus = 200e6, .unit_weight = 9810, .tension = 1e5};
  for (auto& sides : cloud.flow.sides) sides = {Wall::roller, Wall::roller};
  return cloud;
}

/// Amplitude of the first mode in a field of the particles along the last axis.
template <class Space, class T, int Dim, class View>
double amplitude(const State<Space, T, Dim>& s, const View& view) {
  const auto values = on_host(view);
  const auto x = on_host(s.soil.points.coordinate);
  const auto cell = on_host(s.soil.points.cell);
  const auto origin = on_host(s.patches.origin);
  double sum = 0;
  for (int p = 0; p < s.soil.points.count; ++p) {
    const Coord<Dim> from = origin(cell(p) / Patch<Dim>::cells), in = coord_of<Dim>(cell(p));
    const double y = (from[Dim - 1] + in[Dim - 1] + double(x(p)[Dim - 1])) * s.spacing;
    sum += double(values(p)[Dim - 1]) * std::sin(std::numbers::pi * y / k_height);
  }
  return 2 * sum / s.soil.points.count;
}

/// Flux of the particles, by id.
template <class Space, class T, int Dim>
std::vector<double> fluxes(const State<Space, T, Dim>& s) {
  const auto flux = on_host(s.soil.points.flux);
  const auto id = on_host(s.soil.points.id);
  std::vector<double> out(s.soil.points.count);
  for (int p = 0; p < s.soil.points.count; ++p) out[id(p)] = flux(p)[Dim - 1];
  return out;
}

}  // namespace

/// The exact amplitudes are the solution of the mode's three ordinary differential equations (docs/water.md).
TEST_CASE("A saturated column swings and drains as its mode", "[pore_flow]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    auto s = state_of<B>(column<B::dim>(1e-2), P2G::tile);
    run_steps(s, 4e-5, 50);
    CHECK(read_control(s).fault_count == 0);
    CHECK(amplitude(s, s.soil.points.velocity) == Catch::Approx(-4.4108e-5).margin(6e-6));
    CHECK(amplitude(s, s.soil.points.flux) == Catch::Approx(-4.4345e-5).margin(3e-6));
  });
}

TEST_CASE("Every strategy gives water in pores the same flux", "[pore_flow]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    auto reference = state_of<Reference<B::dim>>(column<B::dim>(1e-3), P2G::sequential);
    run_steps(reference, 4e-5, 20);
    const auto expected = fluxes(reference);
    const double most = std::abs(*std::max_element(
        expected.begin(), expected.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
    for (P2G how : k_strategies) {
      auto s = state_of<B>(column<B::dim>(1e-3), how);
      run_steps(s, 4e-5, 20);
      const auto got = fluxes(s);
      double apart = 0;
      for (std::size_t p = 0; p < got.size(); ++p) apart = std::max(apart, std::abs(got[p] - expected[p]));
      INFO(word_of(how));
      CHECK(apart <= B::of(1e-11, 1e-3) * most);
    }
  });
}

TEST_CASE("Accelerations of a node satisfy the equations of mixture and water", "[pore_flow]") {
  Dice dice{std::mt19937_64(1)};
  for (int trial = 0; trial < 1000; ++trial) {
    const FlowNode of = random_node(dice);
    CHECK(of.mass * of.inertia > of.water * of.water);
    const FlowRates rates = solve_flow(of);
    const double scale = std::abs(of.force) + std::abs(of.water_force);
    CHECK(std::abs(of.mass * rates.grains + of.water * rates.flux - of.force) <= 1e-9 * scale);
    CHECK(std::abs(of.water * rates.grains + of.inertia * rates.flux - of.water_force) <= 1e-9 * scale);
  }
}

TEST_CASE("Without permeability the water moves with the grains", "[pore_flow]") {
  const FlowNode of{2000, 1000, 1e20, 300, 500};
  const FlowRates rates = solve_flow(of);
  CHECK(rates.grains == Catch::Approx(of.force / of.mass));
  CHECK(std::abs(rates.flux) < 1e-15);
}

TEST_CASE("The flux of a particle is FLIP where drag is slow, and PIC where it is fast", "[pore_flow]") {
  const WaterInPores water;
  CHECK(flux_flip(0.4, 1e3, water, 1e-6) == Catch::Approx(1).epsilon(1e-6));
  CHECK(flux_flip(0.4, 1e-12, water, 1e-3) < 1e-8);
}

TEST_CASE("Permeability follows Kozeny and Carman from that of the start", "[pore_flow]") {
  Pores pores{true, 0.4, 2650, 1e-4, true};
  CHECK(permeability_at(pores, 0.4) == Catch::Approx(1e-4));
  CHECK(permeability_at(pores, 0.5) == Catch::Approx(1e-4 * (0.125 / 0.25) / (0.064 / 0.36)));
  pores.kozeny = false;
  CHECK(permeability_at(pores, 0.5) == 1e-4);
}

/// Set A of the developers' checks: E 10 MPa, Poisson's ratio 0.25, n 0.4, K_w 200 MPa.
TEST_CASE("The fast wave is that of the equations without drag", "[pore_flow]") {
  CHECK(std::sqrt(fast_wave_square(12e6, 0.4, 2650, 1000, 200e6)) == Catch::Approx(562.12).epsilon(1e-5));
  Dice dice{std::mt19937_64(2)};
  for (int trial = 0; trial < 100; ++trial) {
    const double n = dice.uniform(0.1, 0.9), grains = dice.uniform(1500, 3000),
                 modulus = dice.uniform(1e5, 1e9);
    const double k = dice.uniform(1e6, 2e9), q = k / n, density = (1 - n) * grains + n * 1000;
    // det([M + Q, Q; Q, Q] - c2 [rho, rho_w; rho_w, rho_w / n]) = 0 at the larger root
    const double c2 = fast_wave_square(modulus, n, grains, 1000, k);
    const double det = (modulus + q - c2 * density) * (q - c2 * 1000 / n) - (q - c2 * 1000) * (q - c2 * 1000);
    CHECK(std::abs(det) <= 1e-9 * (modulus + q) * q);
    CHECK(c2 >= (modulus + q) / density * (1 - 1e-12));
  }
}

TEST_CASE("Water that does not flow keeps its mass while its soil is pressed together", "[pore_flow]") {
  WaterInPores water;
  water.bulk_modulus = 1e8;
  const double solid = 0.6, strain = -5e-5;
  double volume = 1, pressure = 0;
  for (int step = 0; step < 1000; ++step) {
    pressure -= water.bulk_modulus / (1 - solid / volume) * strain;
    volume *= (2 + strain) / (2 - strain);
  }
  CHECK(pressure > 0.1 * water.bulk_modulus);
  CHECK((volume - solid) * water_compression(pressure, water) == Catch::Approx(1 - solid).epsilon(2e-5));
}
