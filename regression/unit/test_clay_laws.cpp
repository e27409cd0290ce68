// cam_clay and softening_clay: replays of an independent program, closed forms, and sums of many small
// increments.

#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "element.hpp"
#include "physics/materials/cam_clay.hpp"
#include "physics/materials/softening_clay.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_m = 1, k_lambda = 0.2, k_kappa = 0.04, k_share = 1 - k_kappa / k_lambda, k_p = 1e5;

/// The clay of SOILS' element tests, with one more parameter.
Values clay_with(const char* key, double value) {
  return {{"critical_state_ratio", k_m}, {"lambda", k_lambda}, {"kappa", k_kappa}, {"poisson", 0.25},
          {"specific_volume", 2},        {"pressure_min", 1},  {key, value}};
}
const Values k_softening{{"young", 1.5e6},         {"poisson", 0.49}, {"su", 3000},
                         {"remoulded_ratio", 0.2}, {"xi95", 10},      {"rate_factor", 0.1},
                         {"rate_reference", 1e-3}};

/// The replay of a file is as near as its steps allow, in double and in single precision.
template <template <class> class Law>
void check_replay(const std::string& name, const Values& values, double deviator = 3e-3) {
  const Replay file(name);
  const auto check = [&](const Misfit& misfit, const char* how) {
    CAPTURE(name, how, misfit.mean, misfit.deviator, misfit.plastic_strain);
    CHECK(misfit.mean < 1e-3);
    CHECK(misfit.deviator < deviator);
    CHECK(misfit.plastic_strain < 3e-3);  // of cam_clay: the preconsolidation pressure
  };
  check(replay<Law<double>, 3>(law_of<Law<double>>(values), file, 40), "double 3D");
  check(replay<Law<float>, 3>(law_of<Law<float>>(values), file, 40), "single 3D");
  bool flat = true;
  for (const auto& row : file.rows) flat &= row.strain[2] == 0 && row.strain[4] == 0 && row.strain[5] == 0;
  if (!flat) return;
  check(replay<Law<double>, 2>(law_of<Law<double>>(values), file, 40), "double 2D");
  check(replay<Law<float>, 2>(law_of<Law<float>>(values), file, 40), "single 2D");
}

const Sym k_isotropic{-k_p, -k_p, -k_p, 0, 0, 0};

double deviator_of(const SymTensor<double, 3>& s) { return std::sqrt(3 * second_invariant(s, mean_of(s))); }
bool near(double value, double right, double share) { return std::fabs(value / right - 1) < share; }

/// q/P = n along undrained compression from the critical isotropic state: axial strain.
double axial_strain_at(double n) {
  const double nu = 0.25, v0 = 2, L = k_share, two_atan = 2 * std::atan(n / k_m);
  return k_kappa * L / (v0 * k_m) * (std::log((k_m + n) / (k_m - n)) - two_atan) +
         2 * (1 + nu) * k_kappa / (9 * (1 - 2 * nu) * v0) * (n * (1 - 2 * L) + L * k_m * two_atan);
}

}  // namespace

TEST_CASE("modified Cam-Clay follows an independent program", "[clay_laws]") {
  check_replay<CamClay>("mcc_drained", clay_with("ocr", 1));
  check_replay<CamClay>("mcc_oedometer", clay_with("ocr", 1));
  check_replay<CamClay>("mcc_undrained_ocr1", clay_with("ocr", 1));
  check_replay<CamClay>("mcc_undrained_ocr4", clay_with("ocr", 4));
  check_replay<CamClay>("mcc_random_3d", clay_with("preconsolidation", 150000));
  check_replay<CamClay>("mcc_low_pressure", clay_with("preconsolidation", 8000));
}

TEST_CASE("softening clay follows an independent program", "[clay_laws]") {
  check_replay<SofteningClay>("softening_shear", k_softening);
  check_replay<SofteningClay>("softening_random_ps", k_softening, 2e-2);  // large increments
}

TEST_CASE("undrained triaxial compression of Cam-Clay", "[clay_laws]") {
  const auto at = [](double ocr, double strain) {
    Point<CamClay<double>, 3> point(law_of<CamClay<double>>(clay_with("ocr", ocr)), k_isotropic);
    const int n = static_cast<int>(std::lround(strain / 1e-5));
    double most = 0;
    for (int k = 0; k < n; ++k) {
      point.strain({0.5e-5, -1e-5, 0.5e-5, 0, 0, 0});
      most = std::fmax(most, deviator_of(point.stress));
    }
    return std::array<double, 2>{deviator_of(point.stress), most};
  };
  CHECK(near(at(1, 0.4)[0], 57434.9, 2e-3));
  CHECK(near(at(1, 0.01)[0], 46207.7, 1e-2));
  CHECK(near(at(1, 0.05)[0], 57076.4, 2e-3));
  CHECK(near(at(1, 0.1)[0], 57420.3, 2e-3));
  for (const double n : {0.3, 0.6, 0.9}) {
    const double p = k_p * std::pow(k_m * k_m / (k_m * k_m + n * n), k_share);
    CHECK(near(at(1, axial_strain_at(n))[0], n * p, 1e-2));
  }
  const auto stiff = at(4, 0.5);
  CHECK(near(stiff[0], 174110, 3e-3));
  CHECK(near(stiff[1], 178565, 3e-3));
}

TEST_CASE("drained triaxial compression and constant pressure of Cam-Clay", "[clay_laws]") {
  using Clay = CamClay<double>;
  Point<Clay, 3> point(law_of<Clay>(clay_with("ocr", 1)), k_isotropic);
  double strain = 0;
  const auto press = [&](double to) {
    for (; strain < to - 1e-9; strain += 1e-4)
      point.strain_to({0, -1e-4, 0, 0, 0, 0}, {1, 0, 1, 0, 0, 0}, 0, -k_p);
    return deviator_of(point.stress);
  };
  CHECK(near(press(0.05), 66433.0, 5e-3));
  CHECK(near(press(0.1), 93749.5, 5e-3));
  CHECK(near(press(0.2), 123400, 5e-3));
  CHECK(near(press(1.5), 150000, 5e-3));
  CHECK(near(point.state[Clay::specific_volume], 1.80800, 5e-3));

  // The mean stress stays where the lateral strain gives the volume that it wants: found by halving.
  Point<Clay, 3> sheared(law_of<Clay>(clay_with("ocr", 1)), k_isotropic);
  while (deviator_of(sheared.stress) < 0.8 * k_p) {
    double low = 0, high = 1e-4;
    for (int k = 0; k < 50; ++k) {
      const double middle = (low + high) / 2;
      auto tried = sheared;
      tried.strain({middle, -1e-4, middle, 0, 0, 0});
      (-mean_of(tried.stress) > k_p ? low : high) = middle;
    }
    sheared.strain({high, -1e-4, high, 0, 0, 0});
  }
  CHECK(near(sheared.state[Clay::specific_volume], 1.92085, 2e-3));
}

TEST_CASE("one-dimensional compression of Cam-Clay ends at its own K0", "[clay_laws]") {
  Point<CamClay<double>, 2> point(law_of<CamClay<double>>(clay_with("ocr", 1)), k_isotropic);
  for (int n = 0; n < 3000; ++n) point.strain({0, -1e-4, 0, 0, 0, 0});
  CHECK(near(point.stress[0] / point.stress[1], 0.71903, 2e-3));
}

TEST_CASE("softening clay in simple shear", "[clay_laws]") {
  const auto sheared = [](double surface) {
    Values values = k_softening;
    values.push_back({"surface", surface});
    Point<SofteningClay<double>, 3> point(law_of<SofteningClay<double>>(values), {});
    for (int n = 0; n < 50000; ++n) point.strain({0, 0, 0, 0.5e-4, 0, 0}, 1e-3);  // 0.1 1/s to 5
    return point.stress[3];
  };
  CHECK(near(sheared(SofteningClay<double>::von_mises), 1363.137, 1e-6));
  CHECK(near(sheared(SofteningClay<double>::tresca), 1363.137, 1e-4));  // first order in the step
}

TEST_CASE("triaxial strength of softening clay by its surface", "[clay_laws]") {
  const auto strength = [](double surface) {
    const Values values{
        {"young", 5e5}, {"poisson", 0.49}, {"su", 1000}, {"remoulded_ratio", 1}, {"surface", surface}};
    Point<SofteningClay<double>, 3> point(law_of<SofteningClay<double>>(values), {});
    for (int n = 0; n < 1000; ++n) point.strain({5e-5, -1e-4, 5e-5, 0, 0, 0});
    return deviator_of(point.stress);
  };
  CHECK(near(strength(SofteningClay<double>::von_mises), 1732.050808, 1e-6));
  CHECK(near(strength(SofteningClay<double>::tresca), 2000, 1e-6));
}

TEST_CASE("a smoothed rate comes to the rate in its time", "[clay_laws]") {
  Values values = k_softening;
  values.push_back({"rate_time", 2});
  using Clay = SofteningClay<double>;
  Point<Clay, 2> point(law_of<Clay>(values), {});
  for (int n = 0; n < 2000; ++n) point.strain({0, 0, 0, 0.5e-4, 0, 0}, 1e-3);  // 0.1 1/s
  CHECK(near(point.state[Clay::shear_rate], 0.1 * (1 - std::exp(-1.)), 1e-9));
}

TEST_CASE("a cell of another size changes the strain of softening in proportion", "[clay_laws]") {
  Values values = k_softening;
  values.push_back({"xi95_cell", 0.1});
  auto law = law_of<SofteningClay<double>>(values);
  for (int again = 0; again < 2; ++again) law.prepare_for({.spacing = 0.05});
  CHECK(near(law.xi95, 20, 1e-14));
  CHECK(law.xi95_cell == 0.05);
}

TEST_CASE("a million increments of 1e-7 add up in single precision", "[clay_laws]") {
  constexpr int k_steps = 1000000;
  const float tiny = 1e-7f;
  SECTION("volume and preconsolidation of Cam-Clay on its normal compression line") {
    using Clay = CamClay<float>;
    Point<Clay, 3> point(law_of<Clay>(clay_with("ocr", 1)), k_isotropic);
    Increment<float, float, 3> by{};
    by.dt = 1;
    for (int d = 0; d < 3; ++d) by.strain[d] = -tiny / 3;
    for (int n = 0; n < k_steps; ++n) point.law.update(point.stress, point.state, by);
    const double v = 2 * std::exp(3. * by.strain[0] * k_steps);
    const double p = k_p * std::exp((2 - v) / k_lambda);
    CAPTURE(point.state[Clay::specific_volume], v, point.state[Clay::preconsolidation], p, point.stress[0]);
    CHECK(near(point.state[Clay::specific_volume], v, 1e-6));
    CHECK(near(point.state[Clay::preconsolidation], p, 1e-3));
    CHECK(near(-point.stress[0], point.state[Clay::preconsolidation], 1e-4));
  }
  SECTION("plastic strain of softening clay, beyond 1") {
    using Clay = SofteningClay<float>;
    Point<Clay, 2> rough(law_of<Clay>(k_softening), {});
    Point<SofteningClay<double>, 2> point(law_of<SofteningClay<double>>(k_softening), {});
    rough.state[Clay::plastic_strain] = 1, point.state[Clay::plastic_strain] = 1;
    for (int n = 0; n < k_steps; ++n) {
      rough.strain({0, 0, 0, tiny / 2, 0, 0}, 1e-6);
      point.strain({0, 0, 0, tiny / 2, 0, 0}, 1e-6);
    }
    CAPTURE(rough.state[Clay::plastic_strain], point.state[Clay::plastic_strain]);
    CHECK(point.state[Clay::plastic_strain] > 1.09);
    CHECK(near(rough.state[Clay::plastic_strain] - 1, point.state[Clay::plastic_strain] - 1, 2e-3));
  }
}

TEST_CASE("Cam-Clay has no start without pressure, nor outside of its surface", "[clay_laws]") {
  const auto clay = law_of<CamClay<double>>(clay_with("preconsolidation", 150000));
  const auto key = [&](const Sym& stress) { return clay.start_fault({.stress = stress}).key; };
  CHECK(key(k_isotropic).empty());
  CHECK(key({}) == "stress");
  CHECK(key({1e3, 0, 0, 0, 0, 0}) == "stress");
  CHECK(key({-1e5, -2e5, -1e5, 0, 0, 0}) == "preconsolidation");  // P + q^2/P = 208,333 Pa
  const auto by_ratio = law_of<CamClay<double>>(clay_with("ocr", 2));
  CHECK(near(by_ratio.initial_state({.stress = {-1e5, -2e5, -1e5, 0, 0, 0}})[0], 2 * 208333.333, 1e-6));
}

TEST_CASE("Cam-Clay fails where it has no more pores, or strains too much in a step", "[clay_laws]") {
  using Clay = CamClay<double>;
  Point<Clay, 2> point(law_of<Clay>(clay_with("ocr", 1)), k_isotropic);
  int steps = 0;
  while (!point.law.failed(point.state) && steps < 10000) point.strain({0, -1e-3, 0, 0, 0, 0}), ++steps;
  CHECK(std::abs(steps - 1000 * std::log(2 / 1.02)) < 2);
  Point<Clay, 2> fast(point.law, k_isotropic);
  fast.strain({0, -6.3e-3, 0, 0, 0, 0});
  CHECK(!fast.law.failed(fast.state));
  fast.strain({0, -6.5e-3, 0, 0, 0, 0});
  CHECK(fast.law.failed(fast.state));
  for (const double s : fast.stress.c) CHECK(std::isfinite(s));
}
