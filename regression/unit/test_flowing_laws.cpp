// mu_i, newtonian, yield_stress_fluid, power_elastic, j2_hardening and stiffness that grows with depth:
// replays of an independent program, and closed forms.

#include <array>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "clouds.hpp"
#include "element.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const Values k_grains{{"young", 1e6},         {"poisson", 0.3},           {"mu_static", 0.38},
                      {"mu_dynamic", 0.64},   {"inertial_number", 0.279}, {"grain_diameter", 5e-4},
                      {"grain_density", 2450}};
const Values k_sand{{"bulk_modulus", 2e7},
                    {"pressure_reference", 1e5},
                    {"exponent", 0.5},
                    {"pressure_min", 1},
                    {"poisson", 0.25}};
const Values k_steel{{"young", 2e11}, {"poisson", 0.3}, {"yield_stress", 2.5e8}, {"hardening_modulus", 1e9}};

Values slurry(double n) {
  return {{"bulk_modulus", 1e7},
          {"shear_modulus", 1e4},
          {"yield_stress", 30},
          {"consistency", 5},
          {"exponent", n}};
}

/// Within the tolerances of mean stress and deviator, in double and single precision; of the plastic strain
/// too where the law has one.
template <template <class> class Law>
void check_replay(const std::string& name, const Values& values, bool mean_only = false) {
  const Replay file(name);
  const auto check = [&](const Misfit& misfit, const char* how) {
    CAPTURE(name, how, misfit.mean, misfit.deviator, misfit.plastic_strain);
    CHECK(misfit.mean < 1e-3);
    if (mean_only) return;
    CHECK(misfit.deviator < 3e-3);
    CHECK(misfit.plastic_strain < 3e-3);
  };
  check(replay<Law<double>, 3>(law_of<Law<double>>(values), file, 40), "double 3D");
  check(replay<Law<float>, 3>(law_of<Law<float>>(values), file, 40), "single 3D");
}

/// Shear stress [Pa] after simple shear at a rate [1/s] in n steps of dt [s].
template <class Law>
double sheared(Point<Law, 3>& point, double rate, int n, double dt) {
  for (int k = 0; k < n; ++k) point.strain({0, 0, 0, rate * dt / 2, 0, 0}, dt);
  return point.stress[3];
}

}  // namespace

TEST_CASE("flowing laws follow an independent program", "[flowing_laws]") {
  check_replay<MuI>("mui_shear", k_grains);
  check_replay<YieldStressFluid>("yield_stress_fluid_n1", slurry(1));
  check_replay<YieldStressFluid>("yield_stress_fluid_n0.5", slurry(0.5));
  check_replay<PowerElastic>("power_isotropic", k_sand, true);
}

TEST_CASE("steady shear has the stress of the flow curve", "[flowing_laws]") {
  Point<MuI<double>, 3> grains(law_of<MuI<double>>(k_grains), {-500, -500, -500, 0, 0, 0});
  const double inertial = 20 * 5e-4 * std::sqrt(2450 / 500.);
  const double mu = 0.38 + 0.26 * inertial / (0.279 + inertial);
  const double stress = sheared(grains, 20, 4000, 1e-5);
  CHECK(std::fabs(stress / (500 * mu) - 1) < 1e-6);
  CHECK(std::fabs(stress / 199.5561 - 1) < 1e-6);
  for (const auto& [n, right] : {std::pair{1., 130.}, {0.5, 52.3607}, {2., 30 + 5 * 400.}}) {
    Point<YieldStressFluid<double>, 3> fluid(law_of<YieldStressFluid<double>>(slurry(n)), {});
    CHECK(std::fabs(sheared(fluid, 20, 40000, 1e-4) / right - 1) < 1e-6);
  }
  Point<Newtonian<double>, 3> water(law_of<Newtonian<double>>({{"bulk_modulus", 1e6}, {"viscosity", 5}}), {});
  CHECK(std::fabs(sheared(water, 20, 1, 1e-5) / 100 - 1) < 1e-14);
}

TEST_CASE("a Newtonian fluid keeps its mean stress alone, in whatever frame", "[flowing_laws]") {
  const auto law = law_of<Newtonian<double>>({{"bulk_modulus", 1e6}, {"viscosity", 5}});
  Point<Newtonian<double>, 3> point(law, {-700, -500, -300, 40, 50, 60});
  Increment<double, double, 3> spun{};
  spun.spin.c[0] = 0.3, spun.dt = 1e-3;
  spun.strain = {1e-3, -4e-3, 1e-3, 5e-4, 0, 0};
  law.update(point.stress, point.state, spun);
  const double mean = -500 - 1e6 * 2e-3;
  const std::array right{mean + 10 / 1e-3 * (1e-3 + 2e-3 / 3),
                         mean + 10 / 1e-3 * (-4e-3 + 2e-3 / 3),
                         mean + 10 / 1e-3 * (1e-3 + 2e-3 / 3),
                         5.,
                         0.,
                         0.};
  for (int k = 0; k < 6; ++k) CHECK(std::fabs(point.stress[k] - right[k]) < 1e-9);
}

TEST_CASE("the viscosity bounds the time step, and other laws do not", "[flowing_laws]") {
  const auto index = [](const std::string& name) {
    const auto names = material_models();
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const auto water = make_material<double>(index("newtonian"), {1e6, 10});
  CHECK(std::fabs(largest_time_step(water, 0.05, 1000, 2) / (0.25 * 1000 * 0.0025 / 10) - 1) < 1e-14);
  CHECK(std::fabs(largest_time_step(water, 0.05, 1000, 3) / (1000 * 0.0025 / 10 / 6) - 1) < 1e-14);
  CHECK(std::isinf(largest_time_step(make_material<double>(index("newtonian"), {1e6, 0}), 0.05, 1000, 2)));
  CHECK(std::isinf(largest_time_step(make_material<double>(index("yield_stress_fluid"), {1e7, 1e4, 30, 5}),
                                     0.05, 1000, 2)));
}

TEST_CASE("grains that part carry nothing until they have come together again", "[flowing_laws]") {
  const auto law = law_of<MuI<double>>(k_grains);
  const double bulk = law.bulk_modulus;
  Point<MuI<double>, 3> point(law, {-500, -500, -500, 100, 0, 0});
  point.strain({0.01, 0, 0, 1e-3, 0, 0});
  for (const double s : point.stress.c) CHECK(s == 0);
  CHECK(std::fabs(point.state[MuI<double>::parted] - (0.01 - 500 / bulk)) < 1e-15);
  point.strain({-0.009, 0, 0, 0, 0, 0});
  for (const double s : point.stress.c) CHECK(s == 0);
  for (int n = 0; n < 10; ++n) point.strain({-4e-4 / 3, -4e-4 / 3, -4e-4 / 3, 0, 0, 0});
  const double pressure = -mean_of(point.stress);
  CHECK(std::fabs(pressure / (bulk * 3e-3 + 500) - 1) < 1e-12);
  CHECK(point.state[MuI<double>::parted] == 0);
}

TEST_CASE("a fluid with a yield stress rests, and takes tension where an option allows it",
          "[flowing_laws]") {
  Values values = slurry(0.5);
  Point<YieldStressFluid<double>, 3> point(law_of<YieldStressFluid<double>>(values),
                                           {-100, -100, -100, 29.9, 0, 0});
  for (int n = 0; n < 1000; ++n) point.strain({}, 1);
  CHECK(point.stress[3] == 29.9);
  CHECK(point.state[0] == 0);
  point.strain({1e-4, 0, 0, 0, 0, 0}, 1e-4);
  CHECK(std::fabs(mean_of(point.stress)) < 1e-12);
  values.push_back({"tension", 1});
  Point<YieldStressFluid<double>, 3> glue(law_of<YieldStressFluid<double>>(values),
                                          {-100, -100, -100, 0, 0, 0});
  glue.strain({1e-4, 0, 0, 0, 0, 0}, 1e-4);
  CHECK(std::fabs(mean_of(glue.stress) - 900) < 1e-9);
}

namespace {
/// Largest misfit of y + a y^p = 1 over a range of both, relative to what the exponents allow.
template <class T>
double largest_residual() {
  double worst = 0;
  for (double p = 1; p < 21; p += 0.37)
    for (double log_a = -60; log_a <= 60; log_a += 0.171) {
      const auto root = YieldFlowRoot<T>::of(static_cast<T>(log_a), static_cast<T>(p));
      const double first = root.first, second = root.second;
      const double right = std::exp(double(T(log_a)) + double(T(p)) * std::log(first));
      const double digits = 1 + std::fabs(log_a);  // that an exponent of this size costs
      worst = std::fmax(worst, std::fabs(first + second - 1) / digits);
      worst = std::fmax(worst, std::fabs(right - second) / digits);
    }
  return worst;
}
}  // namespace

TEST_CASE("the flow of a fluid with a yield stress is solved to round-off", "[flowing_laws]") {
  CHECK(largest_residual<double>() < 1e-15);
  CHECK(largest_residual<float>() < 5e-7);
}

TEST_CASE("the flow of a fluid with exponent 1/2 or 2 has both its parts to round-off", "[flowing_laws]") {
  const auto check = [](auto of_type, double allowed) {
    using T = decltype(of_type);
    for (const double n : {0.5, 2.})
      for (const double consistency : {1e-6, 1e-3, 1., 1e5})
        for (double beyond = 1e-6; beyond < 1e9; beyond *= 17)
          for (const double dt : {1e-8, 1e-4, 1.}) {
            auto law = law_of<YieldStressFluid<T>>(slurry(n));
            law.consistency = static_cast<T>(consistency), law.prepare();
            const auto flow = law.flow(static_cast<T>(beyond), static_cast<T>(dt));
            const double elastic = double(law.shear_modulus) * flow.strain,
                         viscous = consistency * std::pow(flow.strain / dt, n);
            CAPTURE(n, consistency, beyond, dt, flow.stress, flow.strain);
            CHECK(std::fabs(flow.stress + elastic - beyond) <= allowed * beyond);
            CHECK(std::fabs(flow.stress - viscous) <= allowed * viscous);
          }
  };
  check(double(), 1e-14);
  check(float(), 2e-6);
}

TEST_CASE("a step of power elasticity has the growth and the moduli of its pressure to round-off",
          "[flowing_laws]") {
  const auto check = [](auto of_type, double allowed) {
    using T = decltype(of_type);
    for (const double n : {0., 0.3, 0.5, 0.999999, 1.}) {
      Values values = k_sand;
      values[2].second = n;
      const auto law = law_of<PowerElastic<T>>(values);
      for (const double p : {10., 1e4, 3e6})
        for (double share = 1e-9; share < 0.1; share *= 3)  // of the pressure, that a step changes it by
          for (const int sign : {-1, 1}) {
            const T modulus = law.bulk_modulus_at(static_cast<T>(p));
            const T compression = static_cast<T>(sign * share * p) / modulus, shear = compression / 3;
            Point<PowerElastic<T>, 3> point(law, {-p, -p, -p, 0, 0, 0});
            point.strain({-compression, 0, 0, shear, 0, 0});
            const double grown = law.growth(static_cast<T>(p), compression),
                         middle = law.bulk_modulus_at(static_cast<T>(p + grown / 2)),
                         sheared = 2 * law.shear_ratio * middle * shear;
            CAPTURE(n, p, share, sign, grown);
            CHECK(std::fabs(-mean_of(point.stress) - p - grown) <= allowed * p);
            CHECK(std::fabs(point.stress[3] - sheared) <= allowed * 10 * std::fabs(sheared));
          }
    }
  };
  check(double(), 1e-15);
  check(float(), 3e-7);
}

TEST_CASE("power elasticity: exact in volume, in parts and through its lowest pressure", "[flowing_laws]") {
  Point<PowerElastic<double>, 3> point(law_of<PowerElastic<double>>(k_sand), {-1e4, -1e4, -1e4, 0, 0, 0});
  for (int n = 0; n < 15; ++n) point.strain({-1e-3 / 3, -1e-3 / 3, -1e-3 / 3, 0, 0, 0});
  CHECK(std::fabs(-mean_of(point.stress) / 329868.3 - 1) < 1e-6);

  for (const double n : {0., 0.3, 0.5, 0.999999, 1.}) {
    const auto law = law_of<PowerElastic<double>>({{"bulk_modulus", 2e7},
                                                   {"pressure_reference", 1e5},
                                                   {"exponent", n},
                                                   {"pressure_offset", 500},
                                                   {"pressure_min", 1000},
                                                   {"poisson", 0.25}});
    for (const double x : {-3000., 900., 1000., 1100., 8000.})
      for (const double strain : {-3e-3, -2e-4, -1e-9, 1e-9, 3e-4, 4e-3}) {
        const double whole = law.growth(x, strain);
        double parts = 0;
        for (int k = 0; k < 1000; ++k) parts += law.growth(x + parts, strain / 1000);
        CAPTURE(n, x, strain, whole);
        CHECK(std::fabs(parts / whole - 1) < 1e-8);
        CHECK(std::fabs(law.growth(x + whole, -strain) / whole + 1) < 1e-6);
      }
    // the stored energy is the work of the pressure
    Point<PowerElastic<double>, 3> pressed(law, {});
    double work = 0;
    for (int k = 0; k < 20000; ++k) {
      const double before = mean_of(pressed.stress);
      pressed.strain({-1e-7, -1e-7, -1e-7, 0, 0, 0});
      work += (before + mean_of(pressed.stress)) / 2 * -3e-7;
    }
    CHECK(std::fabs(law.stored_energy(pressed.stress, pressed.state) / work - 1) < 1e-6);
  }
}

TEST_CASE("a hardening metal under uniaxial stress, in shear and back", "[flowing_laws]") {
  const auto law = law_of<J2Hardening<double>>(k_steel);
  Point<J2Hardening<double>, 3> bar(law, {});
  for (int n = 0; n < 200; ++n) bar.strain_to({0, 1e-4, 0, 0, 0, 0}, {1, 0, 1, 0, 0, 0}, 0, 0);
  const double plastic = 0.02 - bar.stress[1] / 2e11;
  CHECK(std::fabs(bar.stress[1] / (2.5e8 + 1e9 * plastic) - 1) < 1e-6);
  CHECK(std::fabs(bar.state[0] / (std::sqrt(3.) * plastic) - 1) < 1e-6);

  const double shear = law.shear_modulus, first = 2.5e8 / std::sqrt(3.), slope = 1e9 / 3;
  Point<J2Hardening<double>, 3> once(law, {}), slowly(law, {});
  const double right = first + slope * (0.02 - first / shear) * shear / (shear + slope);
  CHECK(std::fabs(sheared(once, 0.02, 1, 1.) / right - 1) < 1e-14);
  CHECK(std::fabs(sheared(slowly, 0.02, 1000, 1e-3) / right - 1) < 1e-12);
  once.strain({0, 0, 0, -1.9 * right / shear / 2, 0, 0});  // back, inside of the grown circle
  CHECK(std::fabs(once.stress[3] / right + 0.9) < 1e-12);
}

TEST_CASE("plastic strain gathers increments far below its round-off", "[flowing_laws]") {
  constexpr int k_steps = 2000000;
  constexpr double k_step = 1e-7;  // of the shear strain
  Values values = k_steel;
  values[2].second = 0;
  const auto law = law_of<J2Hardening<float>>(values);
  Point<J2Hardening<float>, 2> point(law, {});
  point.state[0] = 2;  // where a number of single precision holds no increment below 1.2e-7
  point.stress[3] = law.shear_strength(point.state);
  for (int n = 0; n < k_steps; ++n) point.strain({0, 0, 0, k_step / 2, 0, 0});
  const double share = double(law.shear_modulus) / (double(law.shear_modulus) + double(law.shear_slope));
  const double grown = double(point.state[0]) + double(point.state[1]) - 2;
  CAPTURE(grown);
  CHECK(std::fabs(grown / (k_steps * k_step * share) - 1) < 2e-3);
}

TEST_CASE("stiffness of elastic soil grows with depth, and costs nothing where it does not",
          "[flowing_laws]") {
  const auto soil = make_material<double>(0, {1e6, 0.3, 2e5, 4});
  const auto uniform = make_material<double>(0, {1e6, 0.3});
  CHECK(state_variables(uniform).empty());
  REQUIRE(state_variables(soil).size() == 1);
  CHECK_FALSE(state_variables(soil)[0].changes);
  for (const auto& [height, young] : {std::pair{9., 1e6}, {4., 1e6}, {-1., 2e6}}) {
    CHECK(std::fabs(wave_modulus(soil, height) / wave_modulus(make_material<double>(0, {young, 0.3})) - 1) <
          1e-14);
    CHECK(std::fabs(initial_state(soil, {.height = height}).at(0) / young - 1) < 1e-14);
  }
  CHECK(initial_state(uniform, {.height = -1}).empty());
  auto law = law_of<LinearElastic<double>>(
      {{"young", 1e6}, {"poisson", 0.3}, {"young_gradient", 2e5}, {"young_datum", 5}});
  Point<LinearElastic<double>, 3> deep(law, {}),
      stiff(law_of<LinearElastic<double>>({{"young", 2e6}, {"poisson", 0.3}}), {});
  CHECK(deep.state[0] == 2e6);  // 5 m below the datum
  const Sym by{1e-3, -2e-3, 5e-4, 3e-4, -1e-4, 2e-4};
  deep.strain(by), stiff.strain(by);
  for (int k = 0; k < 6; ++k) CHECK(std::fabs(deep.stress[k] / stiff.stress[k] - 1) < 1e-14);
  CHECK(std::fabs(law.stored_energy(deep.stress, deep.state) /
                      stiff.law.stored_energy(stiff.stress, stiff.state) -
                  1) < 1e-14);
}
