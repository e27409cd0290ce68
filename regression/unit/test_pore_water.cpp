// Water without flow: the buoyant weight at the nodes, submerged ground at rest, and effective stress with an
// excess pore pressure.

#include <array>
#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "loops/cpu/host_particles.hpp"
#include "physics/displaced_mass.hpp"
#include "physics/materials/any.hpp"
#include "transfer/measure.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_spacing = 0.1, k_g = 9.81, k_pore = 3e7;

/// Water at rest with gravity along the last axis and its level at this height [m].
template <int Dim>
Water<Dim> water_at(double level) {
  Water<Dim> water{.density = 1000, .level = level, .down = {}, .gravity = k_g};
  for (int d = 0; d < Dim; ++d) water.down[d] = d == Dim - 1 ? -1 : 0;
  return water;
}

int model_of(const std::string& name) {
  const auto models = material_models();
  return static_cast<int>(std::find(models.begin(), models.end(), name) - models.begin());
}

/// A material of each law whose strength or stiffness follows the effective mean stress, and an elastic one.
std::vector<MaterialInput> laws_of_effective_stress() {
  return {{model_of("linear_elastic"), {1e7, 0.3}},
          {model_of("mohr_coulomb"), {1e7, 0.3, 1e3, 30, 5}},
          {model_of("drucker_prager"), {1e7, 0.3, 1e3, 30, 5, -1, 0, 0, 2}},
          {model_of("power_elastic"), {1e7, 1e5, 0.5, 0, 1e3, 0.3}},
          {model_of("cam_clay"), {1, 0.2, 0.04, 0.25, 0, 2, 2}},
          {model_of("mu_i"), {1e7, 0.3, 0.38, 0.64, 0.279, 5e-4, 2450}}};
}

/// Particles in a few cells that begin with an isotropic effective stress of -100 kPa.
template <int Dim>
Cloud block(const MaterialInput& material) {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({8, 8, 6}, k_spacing, Wall::free);
  cloud.materials = {material};
  cloud.bodies = {body_of<Dim>(lattice<Dim>({2, 2, 2}, {6, 5, 4}, 2, k_spacing), 2, k_spacing, 0)};
  auto& body = cloud.bodies[0];
  const std::size_t count = body.position.size() / Dim;
  const AnyMaterial<double> law = make_material<double>(material.model, material.parameters);
  const ParticleStart start{.position = {}, .height = 0, .stress = {-1e5, -1e5, -1e5, 0, 0, 0}};
  body.state.clear();
  for (const double value : initial_state(law, start))
    body.state.push_back({"", std::vector<double>(count, value)});
  for (std::size_t p = 0; p < count; ++p)
    for (int k = 0; k < sym_size<Dim>; ++k) body.stress.push_back(k < 3 ? -1e5 : 0);
  return cloud;
}

template <int Dim>
Increment<double, double, Dim> random_increment(Dice& dice) {
  Increment<double, double, Dim> by{};
  by.dt = 1e-3;
  for (auto& e : by.strain.c) e = dice.uniform(-2e-4, 1e-4);
  if (Dim == 2) by.strain[2] = 0;
  for (auto& w : by.spin.c) w = dice.uniform(-1e-3, 1e-3);
  return by;
}

/// Isotropic stress of a level column [Pa] by the weight of whole rows of particles.
template <int Dim>
void put_at_rest(Cloud& cloud, const Water<Dim>& water, double top, int per_cell) {
  BodyInput& body = cloud.bodies[0];
  const double h = k_spacing / per_cell;
  const auto weight = [&](double y) {
    Vector<double, Dim> x{};
    x[Dim - 1] = y;
    return (body.density - water.density * water.submerged_share(x, filled<double, Dim>(h / 2))) * k_g * h;
  };
  body.stress.clear();
  for (std::size_t p = 0; p < body.position.size() / Dim; ++p) {
    const double y = body.position[p * Dim + Dim - 1];
    double above = weight(y) / 2;
    for (double row = y + h; row < top; row += h) above += weight(row);
    for (int k = 0; k < sym_size<Dim>; ++k) body.stress.push_back(k < 3 ? -above : 0);
  }
}

/// Mass of the water that all particles displace [kg].
template <class Space, class T, int Dim>
double displaced_by(const State<Space, T, Dim>& s) {
  const DisplacedMass<Space, T, Dim> mass{s.soil.points, s.water, s.density, s.patches.origin, s.spacing};
  double total = 0;
  Kokkos::parallel_reduce(
      "test::displaced", Kokkos::RangePolicy<Space>(0, s.soil.points.count),
      KOKKOS_LAMBDA(int p, double& sum) { sum += mass(p); }, total);
  return total;
}

}  // namespace

TEST_CASE("a particle is submerged by its share below the level", "[pore_water]") {
  const auto water = water_at<2>(3);
  CHECK(water.submerged_share({0, 2}, {0.5, 0.5}) == 1);
  CHECK(water.submerged_share({0, 4}, {0.5, 0.5}) == 0);
  CHECK(std::fabs(water.submerged_share({7, 3.2}, {0.5, 0.5}) - 0.3) < 1e-15);
  CHECK(water.pressure({1, 4}) == 0);
  CHECK(std::fabs(water.pressure({1, 1}) - 2000 * k_g) < 1e-9);
}

TEST_CASE("a region has its own level, and the last one counts where regions overlap", "[pore_water]") {
  auto water = water_at<3>(3);
  water.region_count = 2;
  water.regions[0] = {.lower = {0, 0, 0}, .upper = {2, 2, 2}, .level = 2};
  water.regions[1] = {.lower = {1, 0, 0}, .upper = {3, 2, 2}, .level = -1e12};
  CHECK(std::fabs(water.pressure({0.5, 1, 1}) - 1000 * k_g) < 1e-9);
  CHECK(water.pressure({1.5, 1, 1}) == 0);
  CHECK(std::fabs(water.pressure({4, 1, 1}) - 2000 * k_g) < 1e-9);
  CHECK(water.submerged_share({1.5, 1, 1}, {0.5, 0.5, 0.5}) == 0);
  CHECK(std::fabs(water.submerged_share({0.5, 1, 1.9}, {0.25, 0.25, 0.25}) - 0.7) < 1e-12);
}

TEST_CASE("nodes get the water that the particles displace, by every strategy", "[pore_water]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (Wall wall : {Wall::free, Wall::roller}) {
      const Cloud cloud = random_cloud<Dim>(61, wall);
      double total = 0;
      Table first;
      for (P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        s.water = water_at<Dim>(0.437);
        rebuild(s);
        Kokkos::deep_copy(s.nodes.soil, 0), Kokkos::deep_copy(s.nodes.displaced, 0);
        for (int d = 0; d < Dim; ++d) s.gravity[d] = d == Dim - 1 ? -k_g : 0;
        buoyancy_to_nodes(s);
        const Table displaced = nodes_of(s, s.nodes.displaced), soil = nodes_of(s, s.nodes.soil);
        double sum = 0, wrong = 0;
        for (std::size_t i = 0; i < displaced.value.size(); ++i) {
          sum += displaced.value[i];
          const double force = soil.value[i * soil.width + SoilTerms<Dim>::force + Dim - 1];
          wrong = std::max(wrong, std::fabs(force - k_g * displaced.value[i]));
        }
        if (how == P2G::sequential) total = displaced_by(s);
        if (how == P2G::sequential) first = displaced;
        INFO(build.name() << ' ' << word_of(how));
        CHECK(total > 0);
        CHECK(std::fabs(sum / total - 1) < B::of(1e-12, 1e-5));
        CHECK(wrong < B::of(1e-12, 1e-5) * k_g * total);
        CHECK(largest_difference(displaced, first) < B::of(1e-12, 1e-5) * total);
      }
    }
  });
}

TEST_CASE("submerged ground whose effective stress carries its buoyant weight stays at rest",
          "[pore_water]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const double level : {2.0, 0.65, 0.5}) {
      Cloud cloud;
      cloud.grid = grid_of<Dim>(Dim == 2 ? std::array<int, 3>{4, 14, 0} : std::array<int, 3>{3, 3, 14},
                                k_spacing, Wall::roller);
      cloud.materials = {{0, {1e6, 0.3}}};
      const std::array<double, 3> high =
          Dim == 2 ? std::array<double, 3>{4, 12, 0} : std::array<double, 3>{3, 3, 12};
      cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, high, 2, k_spacing), 2, k_spacing, 0)};
      cloud.bodies[0].state.clear(), cloud.bodies[0].density = 1900;
      cloud.gravity[Dim - 1] = -k_g;
      const auto water = water_at<Dim>(level);
      put_at_rest<Dim>(cloud, water, 1.2, 2);
      for (P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        s.water = water;
        rebuild(s);
        run_steps(s, 1e-3, 20);
        double fastest = 0;
        for (const double v : by_id(s.soil.points, s.soil.points.velocity).value)
          fastest = std::max(fastest, std::fabs(v));
        INFO(build.name() << ' ' << word_of(how) << " level " << level);
        CHECK(fastest < B::of(1e-13, 1e-5) * k_g);
      }
    }
  });
}

TEST_CASE("undrained, a law sees the effective stress that it would see drained", "[pore_water]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    using Space = typename B::Space;
    constexpr int Dim = B::dim;
    using R = Lanes<double, native_lanes<double>>;
    for (MaterialInput material : laws_of_effective_stress()) {
      auto drained = state_of<B>(block<Dim>(material));
      material.pore_stiffness = k_pore;
      auto alone = state_of<B>(block<Dim>(material)), lanes = state_of<B>(block<Dim>(material));
      REQUIRE(alone.soil.points.history.pore >= 0);
      REQUIRE(drained.soil.points.history.pore == -1);
      const auto &of_drained = drained.soil.points, &of_alone = alone.soil.points,
                 &of_lanes = lanes.soil.points;
      SymTensor<double, Dim> effective = of_drained.stress(0), stress = of_alone.stress(0);
      SymTensor<R, Dim> many{};
      for (int k = 0; k < sym_size<Dim>; ++k) many[k] = stress[k];
      Dice dice{std::mt19937_64(17)};
      double volume = 0, worst = 0, worst_lanes = 0, excess = 0;
      for (int n = 0; n < 300; ++n) {
        const auto by = random_increment<Dim>(dice);
        for (int d = 0; d < 3; ++d) volume += by.strain[d];
        ParticleLaw<Space, double, Dim, Materials>{of_drained, 0, 0, -1, false}(effective, by);
        ParticleLaw<Space, double, Dim, Materials>{of_alone, 0, 0, -1, false}(stress, by);
        Increment<R, double, Dim> all{};
        all.dt = by.dt;
        for (int k = 0; k < sym_size<Dim>; ++k) all.strain[k] = by.strain[k];
        for (std::size_t k = 0; k < std::size(by.spin.c); ++k) all.spin.c[k] = by.spin.c[k];
        LawLanes<R, Space, double, Dim>{.soil = of_lanes, .p = 0, .count = R::k_count, .one_law = true}(many,
                                                                                                        all);
        excess = of_alone.history.column[of_alone.history.pore](0);
        for (int k = 0; k < sym_size<Dim>; ++k) {
          const double pore = k < 3 ? excess : 0;
          worst = std::max(worst, std::fabs(stress[k] + pore - effective[k]));
          worst_lanes = std::max(worst_lanes, std::fabs(many[k][1] - stress[k]));
        }
      }
      INFO("model " << material.model);
      CHECK(std::fabs(excess + k_pore * volume) < 1e-9 * k_pore);
      CHECK(std::fabs(excess) > 1e4);
      CHECK(worst < 1e-6 * 1e5);
      CHECK(worst_lanes < 1e-6 * 1e5);
    }
  });
}

TEST_CASE("a particle that flies alone has no excess pore pressure", "[pore_water]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    MaterialInput material = laws_of_effective_stress()[1];
    material.pore_stiffness = k_pore;
    Cloud cloud = block<Dim>(material);
    give_excess_pressure<Dim>(cloud.bodies[0],
                              std::vector<double>(cloud.bodies[0].position.size() / Dim, 4e4));
    auto s = state_of<B>(cloud);
    const auto& soil = s.soil.points;
    SymTensor<double, Dim> stress = soil.stress(3);
    CHECK(std::fabs(stress[0] + 1.4e5) < 1e-6);  // -100 kPa of effective stress less the excess pressure
    Dice dice{std::mt19937_64(5)};
    const auto by = random_increment<Dim>(dice);
    ParticleLaw<typename B::Space, double, Dim, Materials>{soil, 3, 0, -1, true}(stress, by);
    CHECK(stress[0] == 0);
    CHECK(soil.history.column[soil.history.pore](3) == 0);
    CHECK(soil.history.column[soil.history.pore](2) == 4e4);
  });
}

TEST_CASE("pore water stiffens the waves and stores energy", "[pore_water]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    MaterialInput material{0, {1e7, 0.3}};
    material.pore_stiffness = k_pore;
    Cloud cloud = block<Dim>(material);
    auto& body = cloud.bodies[0];
    give_excess_pressure<Dim>(body, std::vector<double>(body.position.size() / Dim, 2e5));
    const auto s = state_of<B>(cloud);
    const double modulus = wave_modulus(make_material<double>(0, material.parameters)) + k_pore;
    INFO(build.name());
    CHECK(std::fabs(fastest_wave(s) / std::sqrt(modulus / k_density) - 1) < B::of(1e-12, 1e-5));
    const double bulk = 1e7 / (3 * (1 - 2 * 0.3)),
                 volume = body.particle_volume * (body.position.size() / Dim);
    const double energy = volume * (1e10 / (2 * bulk) + 4e10 / (2 * k_pore));
    CHECK(std::fabs(measure(s, 0).stored_energy / energy - 1) < B::of(1e-12, 1e-4));
  });
}

TEST_CASE("what water carries of a body that sinks is its displaced weight times the way", "[pore_water]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = block<Dim>({0, {1e7, 0.3}});
    auto s = state_of<B>(cloud);
    const double mass = k_density * cloud.bodies[0].particle_volume * (cloud.bodies[0].position.size() / Dim);
    const double weight = mass * 1000 / k_density * k_g, way = 0.01;
    const auto energy_at = [&](double level) {
      s.water = water_at<Dim>(level);
      return measure(s, 0).water_energy;
    };
    INFO(build.name());
    CHECK(energy_at(0.1) == 0);  // the block begins at 0.2 m
    const double deep = energy_at(1 + way) - energy_at(1);
    CHECK(std::fabs(deep / (weight * way) - 1) < B::of(1e-10, 1e-4));
    double by_steps = 0;  // the level rises through the block
    for (int n = 0; n < 4000; ++n) {
      const double level = 0.15 + (n + 0.5) * 1e-4;
      s.water = water_at<Dim>(level);
      by_steps += displaced_by(s) * k_g * 1e-4;
    }
    CHECK(std::fabs((energy_at(0.55) - energy_at(0.15)) / by_steps - 1) < 1e-4);
  });
}
