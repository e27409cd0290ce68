// tresca, mohr_coulomb and drucker_prager: replays of an independent program, and closed forms.

#include <array>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "element.hpp"
#include "physics/materials/drucker_prager.hpp"
#include "physics/materials/mohr_coulomb.hpp"
#include "physics/materials/tresca.hpp"
#include "physics/materials/von_mises.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_pi = 3.14159265358979323846;
const Values k_clay{{"young", 5e5}, {"poisson", 0.49}, {"su", 1000}};

double slope_of(double degrees) {  // k or m of an angle
  const double s = std::sin(degrees * k_pi / 180);
  return (1 + s) / (1 - s);
}

/// The replay of a file is as near as its steps allow, in double and in single precision.
template <template <class> class Law>
void check_replay(const std::string& name, const Values& values) {
  const Replay file(name);
  const auto check = [&](const Misfit& misfit, const char* how) {
    CAPTURE(name, how, misfit.mean, misfit.deviator, misfit.plastic_strain);
    CHECK(misfit.mean < 1e-3);
    CHECK(misfit.deviator < 3e-3);
    CHECK(misfit.plastic_strain < 3e-3);
  };
  check(replay<Law<double>, 3>(law_of<Law<double>>(values), file, 40, true), "double 3D");
  check(replay<Law<float>, 3>(law_of<Law<float>>(values), file, 40, true), "single 3D");
  bool flat = true;
  for (const auto& row : file.rows) flat &= row.strain[2] == 0 && row.strain[4] == 0 && row.strain[5] == 0;
  if (!flat) return;
  check(replay<Law<double>, 2>(law_of<Law<double>>(values), file, 40, true), "double 2D");
  check(replay<Law<float>, 2>(law_of<Law<float>>(values), file, 40, true), "single 2D");
}

/// How many stresses after a step from each of many stresses of any size are not finite.
template <class Law, int Dim>
int not_finite_of(const Values& values) {
  int bad = 0;
  const auto law = law_of<Law>(values);
  for (double size = 1e-42; size < 1e14; size *= 10)
    for (const Sym& form : {Sym{1, 1, 1, 0, 0, 0}, Sym{-1, -1, -1, 0, 0, 0}, Sym{1, -1, 0, 0, 0, 0},
                            Sym{1, 1, 1, 1, 1, 1}, Sym{0, 0, 0, 1, -1, 0}, Sym{-1, 0.5, 0.5, 1e-9, 0, 1e-20}})
      for (const double strain : {0., 1e-42, 1e-20, 1e-3, 0.2})
        for (const Sym& by : {Sym{1, 1, 1, 0, 0, 0}, Sym{-1, -1, -1, 0, 0, 0}, Sym{1, -1, 0, 1, -1, 1}}) {
          Sym start = form, increment = by;
          for (int k = 0; k < 6; ++k) start[k] *= size, increment[k] *= strain;
          Point<Law, Dim> point(law, start);
          point.strain(increment);
          point.strain({});
          for (const auto& x : point.stress.c) bad += !std::isfinite(x);
          bad += !std::isfinite(point.state[0]);
        }
  return bad;
}

template <template <class> class Law>
void check_finite(const Values& values) {
  CAPTURE(Law<double>::k_name);
  CHECK(not_finite_of<Law<double>, 2>(values) == 0);
  CHECK(not_finite_of<Law<double>, 3>(values) == 0);
  CHECK(not_finite_of<Law<float>, 2>(values) == 0);
  CHECK(not_finite_of<Law<float>, 3>(values) == 0);
}

}  // namespace

TEST_CASE("no finite stress and strain give a number that is not finite", "[frictional_laws]") {
  check_finite<Tresca>(k_clay);
  for (const double cohesion : {0., 1e-30, 5000.}) {
    Values soil{{"young", 2e7}, {"poisson", 0.3}, {"cohesion", cohesion}, {"friction_deg", 30}};
    check_finite<MohrCoulomb>(soil);
    for (const int match : {0, 1, 2}) {
      Values cone = soil;
      cone.push_back({"match", match});
      check_finite<DruckerPrager>(cone);
    }
    soil.push_back({"tension", 0});
    check_finite<MohrCoulomb>(soil);
  }
}

TEST_CASE("random paths in plane strain and 3D follow an independent program", "[frictional_laws]") {
  const Values sand{{"young", 2e7},       {"poisson", 0.3},     {"cohesion", 5000},
                    {"friction_deg", 30}, {"dilation_deg", 10}, {"tension", 2000}};
  const auto cone = [](double match) {
    return Values{{"young", 1e7},      {"poisson", 0.3},  {"cohesion", 8000}, {"friction_deg", 25},
                  {"dilation_deg", 5}, {"tension", 3000}, {"match", match}};
  };
  using Cone = DruckerPrager<double>;
  for (const std::string path : {"random_ps", "random_3d"}) {
    check_replay<Tresca>("tresca_" + path, k_clay);
    check_replay<MohrCoulomb>("mc_" + path, sand);
    check_replay<DruckerPrager>("dp_" + path,
                                cone(path == "random_ps" ? Cone::plane_strain : Cone::compression));
  }
}

TEST_CASE("element tests of Mohr-Coulomb follow an independent program", "[frictional_laws]") {
  const Values sand{
      {"young", 2e7}, {"poisson", 0.3}, {"cohesion", 5000}, {"friction_deg", 30}, {"dilation_deg", 10}};
  check_replay<MohrCoulomb>("mc_triaxial", sand);
  check_replay<MohrCoulomb>("mc_shear", sand);
  check_replay<MohrCoulomb>("mc_oedometer",
                            {{"young", 2e7}, {"poisson", 0.2}, {"cohesion", 0}, {"friction_deg", 30}});
}

TEST_CASE("clay in triaxial and plane-strain compression", "[frictional_laws]") {
  const auto difference = [](auto law, const Sym& by) {  // s1 - s3 at failure
    Point<decltype(law), 3> point(law, {});
    for (int n = 0; n < 1000; ++n) point.strain(by);
    return point.stress[0] - point.stress[1];
  };
  const Sym triaxial{5e-5, -1e-4, 5e-5, 0, 0, 0}, flat{1e-4, -1e-4, 0, 0, 0, 0};
  const auto tresca = law_of<Tresca<double>>(k_clay);
  const auto von_mises = law_of<VonMises<double>>(k_clay);
  CHECK(std::fabs(difference(tresca, flat) / 2000 - 1) < 1e-6);
  CHECK(std::fabs(difference(von_mises, flat) / 2000 - 1) < 1e-6);
  CHECK(std::fabs(difference(tresca, triaxial) / 2000 - 1) < 1e-6);
  CHECK(std::fabs(difference(von_mises, triaxial) / 1732.050808 - 1) < 1e-6);
}

TEST_CASE("drained triaxial tests of Mohr-Coulomb", "[frictional_laws]") {
  const double k = slope_of(30), m = slope_of(10), cell = -1e5;
  const auto sand = law_of<MohrCoulomb<double>>(
      {{"young", 2e7}, {"poisson", 0.3}, {"cohesion", 5000}, {"friction_deg", 30}, {"dilation_deg", 10}});
  Point<MohrCoulomb<double>, 3> point(sand, {cell, cell, cell, 0, 0, 0});
  for (int n = 0; n < 400; ++n) point.strain_to({0, -1e-4, 0, 0, 0, 0}, {1, 0, 1, 0, 0, 0}, 0, cell);
  CHECK(std::fabs((point.stress[0] - point.stress[1]) / ((k - 1) * 1e5 + 2 * 5000 * std::sqrt(k)) - 1) <
        1e-6);
  CHECK(std::fabs((point.stress[0] - point.stress[1]) / 217320.5 - 1) < 1e-6);
  CHECK(std::fabs(point.stress[2] - cell) < 1e-3);

  // at failure all strain is plastic, and its rates are those of the flow
  const auto before = point;
  double lateral = 0;
  const auto rest = [&](double e) {
    auto next = before;
    next.strain({e, -1e-4, e, 0, 0, 0});
    return next.stress[0] - cell;
  };
  double low = 0, high = 1e-3;
  for (int n = 0; n < 100; ++n) (rest(lateral = (low + high) / 2) < 0 ? low : high) = lateral;
  CHECK(std::fabs((-2 * lateral + 1e-4) / 1e-4 - (1 - m)) < 1e-6);
  CHECK(std::fabs(1 - m + 0.420277) < 1e-6);

  Point<MohrCoulomb<double>, 3> extended(sand, {cell, cell, cell, 0, 0, 0});
  for (int n = 0; n < 400; ++n) extended.strain_to({0, 1e-4, 0, 0, 0, 0}, {1, 0, 1, 0, 0, 0}, 0, cell);
  CHECK(std::fabs(-extended.stress[1] / 27559.8 - 1) < 2e-6);
  CHECK(std::fabs(-extended.stress[1] / ((1e5 - 2 * 5000 * std::sqrt(k)) / k) - 1) < 1e-6);
}

TEST_CASE("simple shear of Mohr-Coulomb (Davis 1968)", "[frictional_laws]") {
  const Values values{{"young", 2e7}, {"poisson", 0.3}, {"cohesion", 5000}, {"friction_deg", 30}};
  Values dilates = values;
  dilates.push_back({"dilation_deg", 10});
  Point<MohrCoulomb<double>, 2> drained(law_of<MohrCoulomb<double>>(dilates), {-1e5, -1e5, -1e5, 0, 0, 0});
  for (int n = 0; n < 4000; ++n) {
    drained.strain_to({0, 0, 0, 5e-5, 0, 0}, {0, 1, 0, 0, 0, 0}, 1, -1e5);
    if (n == 299) CHECK(std::fabs(drained.stress[3] / (0.99 * 58591.9) - 1) < 3e-3);
  }
  CHECK(std::fabs(drained.stress[3] / 58591.9 - 1) < 1e-4);

  Point<MohrCoulomb<double>, 2> closed(law_of<MohrCoulomb<double>>(values), {-1e5, -1e5, -1e5, 0, 0, 0});
  for (int n = 0; n < 4000; ++n) closed.strain({0, 0, 0, 5e-5, 0, 0});
  CHECK(std::fabs(closed.stress[3] / 54330.1 - 1) < 1e-4);
}

TEST_CASE("confined compression of sand: active earth pressure and modulus", "[frictional_laws]") {
  const auto law =
      law_of<MohrCoulomb<double>>({{"young", 2e7}, {"poisson", 0.2}, {"cohesion", 0}, {"friction_deg", 30}});
  Point<MohrCoulomb<double>, 2> point(law, {-1000, -1000, -1000, 0, 0, 0});
  for (int n = 0; n < 1000; ++n) point.strain({0, -1e-5, 0, 0, 0, 0});
  const double before = point.stress[1];
  CHECK(std::fabs(point.stress[0] / before - 1 / 3.) < 1e-6);
  CHECK(std::fabs(point.stress[2] / before - 1 / 3.) < 1e-6);
  point.strain({0, -1e-4, 0, 0, 0, 0});
  CHECK(std::fabs((before - point.stress[1]) / 1e-4 / 20.000e6 - 1) < 1e-6);
}

TEST_CASE("plane-strain compression of the matched cone carries what Mohr-Coulomb does",
          "[frictional_laws]") {
  for (const double psi : {0., 5., 25.}) {
    const auto law = law_of<DruckerPrager<double>>({{"young", 1e7},
                                                    {"poisson", 0.3},
                                                    {"cohesion", 8000},
                                                    {"friction_deg", 25},
                                                    {"dilation_deg", psi},
                                                    {"match", DruckerPrager<double>::plane_strain}});
    Point<DruckerPrager<double>, 2> point(law, {-5e4, -5e4, -5e4, 0, 0, 0});
    for (int n = 0; n < 4000; ++n) point.strain_to({0, -5e-5, 0, 0, 0, 0}, {1, 0, 0, 0, 0, 0}, 0, -5e4);
    CAPTURE(psi);
    CHECK(std::fabs((point.stress[0] - point.stress[1]) / 98310.6 - 1) < 1e-4);
  }
}

TEST_CASE("the cones touch Mohr-Coulomb in triaxial compression and extension", "[frictional_laws]") {
  const double k = slope_of(32), c = 3000, cell = -6e4;
  using Cone = DruckerPrager<double>;
  for (const int match : {Cone::compression, Cone::extension}) {
    const double sign = match == Cone::compression ? -1 : 1;
    const auto law = law_of<Cone>({{"young", 2e7},
                                   {"poisson", 0.25},
                                   {"cohesion", c},
                                   {"friction_deg", 32},
                                   {"dilation_deg", 4},
                                   {"match", double(match)}});
    Point<Cone, 3> point(law, {cell, cell, cell, 0, 0, 0});
    for (int n = 0; n < 1000; ++n) point.strain_to({0, sign * 1e-4, 0, 0, 0, 0}, {1, 0, 1, 0, 0, 0}, 0, cell);
    const double axial =
        match == Cone::compression ? k * cell - 2 * c * std::sqrt(k) : (cell + 2 * c * std::sqrt(k)) / k;
    CAPTURE(match);
    CHECK(std::fabs(point.stress[1] / axial - 1) < 1e-6);
  }
}

TEST_CASE("a cone without friction is von Mises, a pyramid without friction Tresca", "[frictional_laws]") {
  const Values soil{{"young", 2e6}, {"poisson", 0.4}, {"cohesion", 3000}, {"friction_deg", 0}};
  const auto clay = [](double su) { return Values{{"young", 2e6}, {"poisson", 0.4}, {"su", su}}; };
  const auto follow = [](auto law) {
    Point<decltype(law), 3> point(law, {});
    for (int n = 0; n < 2000; ++n)
      point.strain({1e-3 * std::sin(n * 0.1), 1e-3 * std::cos(n * 0.13), -2e-4, 1e-3 * std::sin(n * 0.07 + 1),
                    5e-4 * std::cos(n * 0.2), 2e-4});
    return point;
  };
  for (const int match : {0, 1, 2}) {
    Values cone = soil;
    cone.push_back({"match", match});
    const auto a = follow(law_of<DruckerPrager<double>>(cone));
    // the circle through the corners of Tresca's hexagon, or touching its sides
    const double su = match == DruckerPrager<double>::plane_strain ? 3000 : 3000 * 2 / std::sqrt(3.);
    const auto b = follow(law_of<VonMises<double>>(clay(su)));
    for (int k = 0; k < 6; ++k) CHECK(std::fabs(a.stress[k] - b.stress[k]) < 1e-6);
    CHECK(std::fabs(a.state[0] / b.state[0] - 1) < 1e-9);
    CHECK(b.state[0] > 0.1);
  }
  const auto a = follow(law_of<MohrCoulomb<double>>(soil));
  const auto b = follow(law_of<Tresca<double>>(clay(3000)));
  for (int k = 0; k < 6; ++k) CHECK(std::fabs(a.stress[k] - b.stress[k]) < 1e-6);
  CHECK(std::fabs(a.state[0] / b.state[0] - 1) < 1e-12);
}

TEST_CASE("cohesion and strength grow with depth and belong to the particle", "[frictional_laws]") {
  const auto sand = law_of<MohrCoulomb<double>>({{"young", 2e7},
                                                 {"poisson", 0.3},
                                                 {"cohesion", 5000},
                                                 {"friction_deg", 30},
                                                 {"cohesion_gradient", 1000},
                                                 {"cohesion_datum", 2}});
  CHECK(sand.initial_state({.height = 3})[1] == 5000);
  CHECK(sand.initial_state({.height = -1})[1] == 8000);
  Point<MohrCoulomb<double>, 3> point(sand, {});
  point.state[1] = 8000;
  for (int n = 0; n < 100; ++n) point.strain({1e-3, 1e-3, 1e-3, 0, 0, 0});  // to the apex of its own cohesion
  for (int k = 0; k < 3; ++k) CHECK(std::fabs(point.stress[k] / (8000 / std::tan(k_pi / 6)) - 1) < 1e-12);

  auto clay = law_of<Tresca<double>>({{"young", 5e5}, {"poisson", 0.49}, {"su", 1000}, {"su_gradient", 100}});
  CHECK(clay.initial_state({.height = -5})[1] == 1500);
  Point<Tresca<double>, 2> deep(clay, {});
  deep.state[1] = 1500;
  for (int n = 0; n < 1000; ++n) deep.strain({0, 0, 0, 1e-4, 0, 0});
  CHECK(std::fabs(deep.stress[3] / 1500 - 1) < 1e-12);
}

TEST_CASE("a cut-off holds the largest principal stress, the cap the mean stress", "[frictional_laws]") {
  Values values{
      {"young", 2e7}, {"poisson", 0.2}, {"cohesion", 5000}, {"friction_deg", 30}, {"tension", 1500}};
  Point<MohrCoulomb<double>, 2> pulled(law_of<MohrCoulomb<double>>(values), {});
  for (int n = 0; n < 100; ++n) pulled.strain({1e-5, 0, 0, 0, 0, 0});
  CHECK(std::fabs(pulled.stress[0] / 1500 - 1) < 1e-12);
  CHECK(std::fabs(pulled.stress[1] / 1500 - 0.25) < 1e-12);  // elastic, by nu / (1 - nu)
  values.push_back({"match", DruckerPrager<double>::compression});
  Point<DruckerPrager<double>, 3> swollen(law_of<DruckerPrager<double>>(values), {});
  for (int n = 0; n < 100; ++n) swollen.strain({1e-5, 1e-5, 1e-5, 1e-6, 0, 0});
  CHECK(std::fabs(mean_of(swollen.stress) / 1500 - 1) < 1e-12);
  CHECK(std::fabs(swollen.stress[3] / (1e-4 * 2e7 / 1.2) - 1) < 1e-9);  // shear stays elastic
  CHECK(law_of<MohrCoulomb<double>>(
            {{"young", 2e7}, {"poisson", 0.2}, {"cohesion", 5000}, {"friction_deg", 30}, {"tension", 9000}})
            .warning()
            .find("8660.25 Pa") != std::string::npos);
}

namespace {

/// Largest difference of two laws on random paths, over the largest stress.
template <class Law>
double apart(const Values& one, const Values& other) {
  Point<Law, 3> a(law_of<Law>(one), {}), b(law_of<Law>(other), {});
  Dice dice{std::mt19937_64(5)};
  double largest = 0, most = 0;
  for (int n = 0; n < 500; ++n) {
    const Sym by = random_sym(dice, 3e-4, false);
    a.strain(by), b.strain(by);
    for (int k = 0; k < 6; ++k) {
      most = std::max(most, std::fabs(a.stress[k] - b.stress[k]));
      largest = std::max(largest, std::fabs(a.stress[k]));
    }
  }
  CHECK(a.state[0] > 0.01);  // plastic strain
  return most / largest;
}

}  // namespace

TEST_CASE("a strength factor divides strengths and tan(friction), and keeps the stiffness",
          "[frictional_laws]") {
  constexpr double k_factor = 1.6;
  const double angle = std::atan(std::tan(30 * k_pi / 180) / k_factor) * 180 / k_pi;
  Values whole{
      {"young", 2e7}, {"poisson", 0.3}, {"cohesion", 8000}, {"friction_deg", 30}, {"dilation_deg", 5}},
      less{{"young", 2e7},
           {"poisson", 0.3},
           {"cohesion", 8000 / k_factor},
           {"friction_deg", angle},
           {"dilation_deg", 5}};
  whole.push_back({"strength_factor", k_factor});
  CHECK(apart<MohrCoulomb<double>>(whole, less) < 1e-9);
  for (Values* values : {&whole, &less}) values->push_back({"match", DruckerPrager<double>::extension});
  CHECK(apart<DruckerPrager<double>>(whole, less) < 1e-9);
  for (Values* values : {&whole, &less}) (*values)[4].second = values == &whole ? 25 : angle;  // dilation
  CHECK(apart<DruckerPrager<double>>(whole, less) < 1e-9);

  Values clay = k_clay, weak = k_clay;
  clay.push_back({"strength_factor", k_factor}), weak[2].second /= k_factor;
  CHECK(apart<Tresca<double>>(clay, weak) < 1e-9);
  CHECK(apart<VonMises<double>>(clay, weak) < 1e-9);
  const auto law = law_of<Tresca<double>>(clay);
  CHECK(std::fabs(law.shear_strength(Point<Tresca<double>, 2>(law, {}).state) * k_factor / 1000 - 1) < 1e-14);
}

TEST_CASE("a strength by the vertical stress is not below that by the depth", "[frictional_laws]") {
  const auto clay = law_of<Tresca<double>>(
      {{"young", 5e5}, {"poisson", 0.49}, {"su", 1000}, {"su_gradient", 100}, {"su_ratio", 0.25}});
  CHECK(clay.initial_state({.height = -5, .stress = {-9e3, -4e3, -7e3, 0, 0, 0}})[1] == 1500);
  CHECK(clay.initial_state({.height = -5, .stress = {-9e3, -8e3, -7e3, 0, 0, 0}})[1] == 2000);
  CHECK(clay.initial_state({.height = -5, .stress = {-9e3, -8e3, -7e3, 0, 0, 0}, .own = {}, .up = 2})[1] ==
        1750);
  CHECK(clay.initial_state({.height = -5, .stress = {-9e3, 8e3, -7e3, 0, 0, 0}})[1] == 1500);
}
