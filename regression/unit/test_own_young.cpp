// A Young's modulus of each particle: laws against one modulus, what particles carry, and soil of several
// moduli against several materials.

#include <array>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "common/material_table.hpp"
#include "compare.hpp"
#include "element.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A law with a modulus of each particle, and the parameters beside young and poisson that it needs.
struct OwnYoung {
  const char* model;
  Values others;
};
const std::vector<OwnYoung>& laws() {
  static const std::vector<OwnYoung> all = {
      {"linear_elastic", {}},
      {"von_mises", {{"su", 2e3}}},
      {"tresca", {{"su", 2e3}, {"tension", 500}}},
      {"softening_clay", {{"su", 2e3}, {"remoulded_ratio", 0.3}, {"xi95", 5}}},
      {"softening_clay",
       {{"su", 2e3},
        {"remoulded_ratio", 0.3},
        {"xi95", 5},
        {"surface", 1},
        {"rate_factor", 0.1},
        {"rate_reference", 1e-3},
        {"rate_time", 1}}},
      {"mohr_coulomb", {{"cohesion", 1e3}, {"friction_deg", 30}, {"dilation_deg", 10}}},
      {"drucker_prager", {{"cohesion", 1e3}, {"friction_deg", 30}, {"dilation_deg", 10}, {"match", 2}}},
      {"j2_hardening", {{"yield_stress", 3e3}, {"hardening_modulus", 1e5}}}};
  return all;
}

/// Parameters in the order of the law's table.
std::vector<double> parameters_of(const OwnYoung& law, const Values& elastic) {
  std::vector<double> values;
  AnyMaterial<double> any;
  any.visit_as(Materials{}, model_index(law.model), [&](const auto& of) {
    for (const auto& parameter : of.parameters()) {
      double value = parameter.standard;
      for (const Values* given : {&law.others, &elastic})
        for (const auto& [key, number] : *given)
          if (key == parameter.key) value = number;
      values.push_back(value);
    }
  });
  return values;
}
std::vector<double> of_particle(const OwnYoung& law) {
  return parameters_of(law, {{"young", k_young_of_particle}, {"poisson", 0.3}});
}
std::vector<double> one_modulus(const OwnYoung& law, double young) {
  return parameters_of(law, {{"young", young}, {"poisson", 0.3}});
}

/// The place of Young's modulus among the parameters of which particles have their own.
int place_of_young(const OwnYoung& law) {
  return static_cast<int>(own_parameters(state_variables(std::string(law.model))).size()) - 1;
}
OwnValues own_young(const OwnYoung& law, double young) {
  OwnValues own{};
  own[place_of_young(law)] = young;
  return own;
}

constexpr double k_spacing = 0.1;

/// A block that moves at random, with one body in each half, or with both halves in one body. moduli [Pa]: of
/// the left half and the right half.
template <int Dim>
Cloud halves(const OwnYoung& law, const std::array<double, 2>& moduli, bool one_body) {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({12, 9, 7}, k_spacing, Wall::free);
  cloud.f_bar_fraction = 0;
  Dice dice{std::mt19937_64(5)};
  for (int half = 0; half < 2; ++half) {
    const double left = 3.0 + 3 * half;
    BodyInput body =
        body_of<Dim>(lattice<Dim>({left, 2, 2}, {left + 3, 6, 5}, 2, k_spacing), 2, k_spacing, half);
    const std::size_t count = body.position.size() / Dim;
    for (std::size_t n = 0; n < count * Dim; ++n) body.velocity.push_back(dice.uniform(-0.5, 0.5));
    for (std::size_t n = 0; n < count; ++n)
      for (int k = 0; k < sym_size<Dim>; ++k) body.stress.push_back(k < 3 ? -2e3 : dice.uniform(-100, 100));
    const auto parameters = one_body ? of_particle(law) : one_modulus(law, moduli[half]);
    if (!one_body || half == 0) cloud.materials.push_back({model_index(law.model), parameters});
    if (one_body) body.material = 0;
    body.state.clear();
    ParticleStart start;
    if (one_body) start.own = own_young(law, moduli[half]);
    const AnyMaterial<double> material = make_material<double>(model_index(law.model), parameters);
    for (const double value : initial_state(material, start))
      body.state.push_back({"", std::vector<double>(count, value)});
    cloud.bodies.push_back(std::move(body));
  }
  if (!one_body) return cloud;
  BodyInput& all = cloud.bodies[0];
  const BodyInput right = std::move(cloud.bodies[1]);
  cloud.bodies.pop_back();
  const auto join = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  join(all.position, right.position), join(all.velocity, right.velocity);
  join(all.stress, right.stress);
  for (std::size_t k = 0; k < all.state.size(); ++k) join(all.state[k].values, right.state[k].values);
  return cloud;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::fmax(most, std::fabs(value));
  return most;
}
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::fmax(most, std::fabs(a[k] - b[k]));
  return most;
}

}  // namespace

TEST_CASE("a law with a modulus of each particle is the law with that modulus", "[own_young]") {
  constexpr double k_young = 3.7e6;
  for (const OwnYoung& law : laws()) {
    INFO(law.model);
    const int model = model_index(law.model);
    const auto own = make_material<double>(model, of_particle(law)),
               one = make_material<double>(model, one_modulus(law, k_young));
    CHECK(parameter_fault(own).key.empty());
    CHECK(std::fabs(wave_modulus(own, 0, {}, own_young(law, k_young)) / wave_modulus(one) - 1) < 1e-14);
    own.visit([&](const auto& of) {
      using Law = std::decay_t<decltype(of)>;
      if constexpr (requires { of.young_gradient; }) {
        Point<Law, 3> a(of, {}), b(*reinterpret_cast<const Law*>(one.bytes), {});
        const auto start = of.initial_state({.own = own_young(law, k_young)});
        for (int k = 0; k < state_size<Law>; ++k) a.state[k] = start[k];
        Dice dice{std::mt19937_64(3)};
        double apart = 0;
        for (int n = 0; n < 400; ++n) {
          const Sym by = random_sym(dice, 2e-4, false);
          a.strain(by), b.strain(by);
          for (int k = 0; k < 6; ++k) apart = std::fmax(apart, std::fabs(a.stress[k] - b.stress[k]));
        }
        CHECK(apart < 1e-7);  // Pa, of kPa
        CHECK(std::fabs(a.law.stored_energy(a.stress, a.state) - b.law.stored_energy(b.stress, b.state)) <
              1e-9 * b.law.stored_energy(b.stress, b.state));
      }
    });
  }
}

TEST_CASE("only particles whose modulus varies carry it", "[own_young]") {
  for (const OwnYoung& law : laws()) {
    INFO(law.model);
    const int model = model_index(law.model);
    const auto one = state_variables(model, one_modulus(law, 1e6)),
               own = state_variables(model, of_particle(law));
    const auto deep = state_variables(
        model, parameters_of(law, {{"young", 1e6}, {"poisson", 0.3}, {"young_gradient", 1e5}}));
    CHECK(own.size() == deep.size());
    CHECK(own.back().parameter == std::string("young"));
    for (const StateVariable& variable : one) CHECK(variable.name != std::string("young"));
    CHECK(own.size() > one.size());
    for (std::size_t k = 0; k < one.size(); ++k) CHECK(own[k].name == std::string(one[k].name));
  }
}

TEST_CASE("a modulus that grows with depth is that of the height of creation", "[own_young]") {
  for (const OwnYoung& law : laws()) {
    INFO(law.model);
    const int model = model_index(law.model);
    const auto deep = make_material<double>(
        model,
        parameters_of(law, {{"young", 1e6}, {"poisson", 0.3}, {"young_gradient", 2e5}, {"young_datum", 4}}));
    for (const auto& [height, young] : {std::pair{9., 1e6}, {4., 1e6}, {-1., 2e6}}) {
      CHECK(std::fabs(wave_modulus(deep, height) /
                          wave_modulus(make_material<double>(model, one_modulus(law, young))) -
                      1) < 1e-14);
      CHECK(std::fabs(initial_state(deep, {.height = height}).back() / young - 1) < 1e-14);
    }
    const auto field = parameter_fault(make_material<double>(
        model,
        parameters_of(law, {{"young", k_young_of_particle}, {"poisson", 0.3}, {"young_gradient", 2e5}})));
    CHECK(field.key == "young_gradient");
  }
}

TEST_CASE("soil of two moduli is two materials", "[own_young]") {
  constexpr int k_steps = 30;
  const std::array<double, 2> moduli = {2e6, 9e6};
  for_each_build([&]<class B>(B) {
    for (const OwnYoung& law : laws())
      for (const P2G how : k_strategies) {
        INFO(B::name() << " " << law.model << " strategy " << static_cast<int>(how));
        auto one = state_of<B>(halves<B::dim>(law, moduli, true), how),
             two = state_of<B>(halves<B::dim>(law, moduli, false), how);
        const double dt = 0.2 * k_spacing / std::sqrt(2 * moduli[1] / k_density);
        run_steps(one, dt, k_steps), run_steps(two, dt, k_steps);
        const SoilFields a = download_soil(one), b = download_soil(two);
        CHECK(difference(a.position, b.position) < B::of(1e-12, 1e-5));
        CHECK(difference(a.stress, b.stress) < B::of(1e-9, 5e-3) * largest(b.stress));
        const std::vector<double>& held = a.history.back();
        for (std::size_t p = 0; p < held.size(); ++p) CHECK(held[p] == moduli[p < held.size() / 2 ? 0 : 1]);
      }
  });
}
