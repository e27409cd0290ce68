// Soil that parts: its gap must close before it takes pressure, on any path.

#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"
#include "element.hpp"
#include "law_lanes.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const Values k_elastic = {{"young", 2e7}, {"poisson", 0.25}};
constexpr double k_bulk = 2e7 / 1.5, k_pressure = 2000;  // Pa

Values with(Values values, const Values& more) {
  values.insert(values.end(), more.begin(), more.end());
  return values;
}
Values soil(double cohesion, double dilation, double tension) {
  return with(
      k_elastic,
      {{"cohesion", cohesion}, {"friction_deg", 30}, {"dilation_deg", dilation}, {"tension", tension}});
}
Values cone(double cohesion, double dilation, double tension) {
  return with(soil(cohesion, dilation, tension), {{"match", DruckerPrager<double>::plane_strain}});
}
const Values k_grains = with(k_elastic, {{"mu_static", 0.4},
                                         {"mu_dynamic", 0.6},
                                         {"inertial_number", 0.3},
                                         {"grain_diameter", 1e-3},
                                         {"grain_density", 2600}});
const Values k_mud = {
    {"bulk_modulus", k_bulk}, {"shear_modulus", 8e6}, {"yield_stress", 500}, {"consistency", 5}};
const Values k_clay = {{"critical_state_ratio", 1}, {"lambda", 0.2}, {"kappa", 0.02},      {"poisson", 0.25},
                       {"specific_volume", 2},      {"ocr", 2},      {"pressure_min", 100}};

/// Calls what(law of k_name) for all laws that part, in double. sheared: their flow has no dilatancy.
template <class What>
void for_each_law(const What& what) {
  for (const double cohesion : {0.0, 3e3})
    for (const double tension : {k_no_tension, 0.0, 1e3}) {
      what(law_of<MohrCoulomb<double>>(soil(cohesion, 0, tension)));
      what(law_of<DruckerPrager<double>>(cone(cohesion, 0, tension)));
    }
  for (const double tension : {0.0, 1e3})
    what(law_of<Tresca<double>>(with(k_elastic, {{"su", 4e3}, {"tension", tension}})));
  what(law_of<MuI<double>>(k_grains));
  what(law_of<YieldStressFluid<double>>(k_mud));
}

template <class Law, int Dim>
double gap_of(const Point<Law, Dim>& point) {
  return point.state[Law::parted];
}
template <class Law, int Dim>
double largest_stress(const Point<Law, Dim>& point) {
  double most = 0;
  for (const double s : point.stress.c) most = std::fmax(most, std::fabs(s));
  return most;
}
/// The most compressive principal stress [Pa].
template <class Law>
double least_stress(const Point<Law, 3>& point) {
  const double mean = mean_of(point.stress);
  return sorted_down(principal_of(point.stress, mean).value).value[2] + mean;
}

/// Parts by a volume strain in n increments and comes back. Along the way nothing is pressed while there is a
/// gap; at the end stress and state are those of the start.
template <class Law>
void check_cycle(const Law& law, double volume, int n) {
  Point<Law, 3> point(law, {-k_pressure, -k_pressure, -k_pressure, 0, 0, 0});
  const auto start = point;
  const double part = volume / 3 / n;
  for (int k = 0; k < n; ++k) point.strain({part, part, part, 0, 0, 0});
  INFO(Law::k_name << " " << volume << " " << n);
  CHECK(gap_of(point) > 0.5 * volume);
  double most = 0;
  for (int k = 0; k < n; ++k) {
    const double before = gap_of(point);
    point.strain({-part, -part, -part, 0, 0, 0});
    if (before > 0 && gap_of(point) > 0) most = std::fmax(most, -least_stress(point));
  }
  CHECK(most < 1e-9 * k_pressure);
  CHECK(gap_of(point) == 0);
  for (int k = 0; k < 6; ++k) CHECK(std::fabs(point.stress[k] - start.stress[k]) < 1e-6 * k_pressure);
}

}  // namespace

TEST_CASE("soil that parts and comes back has the stress that it had", "[parting]") {
  for (const double volume : {2e-3, 0.05, 1.0})
    for (const int n : {1, 7, 1000}) for_each_law([&](const auto& law) { check_cycle(law, volume, n); });
}

TEST_CASE("on random paths the volume is that of the pressure and of the gap", "[parting]") {
  Dice dice{std::mt19937_64(31)};
  long parted = 0, pressed = 0;
  for (int path = 0; path < 40; ++path)
    for_each_law([&](const auto& law) {
      using Law = std::remove_cvref_t<decltype(law)>;
      Point<Law, 3> point(law, {-k_pressure, -k_pressure, -k_pressure, 0, 0, 0});
      double volume = 0, apart = 0, pressure_in_gap = 0, size = k_pressure;
      Sym by{};
      for (int n = 0; n < 400; ++n) {
        if (n % 20 == 0) by = random_sym(dice, std::pow(10, dice.uniform(-6, -3)), false);
        // back and forth about the volume of the start
        const double back = -0.02 * volume / 3 + (n % 40 < 20 ? 1e-5 : -1e-5);
        Sym both = by;
        for (int k = 0; k < 3; ++k) both[k] += back, volume += both[k];
        point.strain(both);
        size = std::fmax(size, largest_stress(point));
        const double gap = gap_of(point), mean = mean_of(point.stress);
        apart = std::fmax(apart, std::fabs(volume - (mean + k_pressure) / k_bulk - gap));
        if (gap > 1e-9) pressure_in_gap = std::fmax(pressure_in_gap, -mean / size);
        ++(gap > 0 ? parted : pressed);
        if (gap < 0) apart = 1;
      }
      INFO(Law::k_name);
      CHECK(apart < 1e-12 + 1e-11 * size / k_bulk);
      if constexpr (!requires { law.shape; }) {
        CHECK(pressure_in_gap < 1e-12);
      } else if constexpr (requires { law.cohesion; }) {
        if (law.cohesion == 0 || law.tension < 0) CHECK(pressure_in_gap < 1e-12);
      }
    });
  CHECK(parted > 20000);
  CHECK(pressed > 20000);
}

TEST_CASE("dilatancy of grains in contact is no gap, and a gap has none", "[parting]") {
  const auto check = [](const auto& law) {
    using Law = std::remove_cvref_t<decltype(law)>;
    Point<Law, 3> point(law, {-k_pressure, -k_pressure, -k_pressure, 0, 0, 0});
    for (int n = 0; n < 1000; ++n) {  // sheared, with the room that its dilatancy asks for
      point.strain({0, 0, 0, 1e-5, 0, 0});
      point.strain_to({}, {0, 1, 0, 0, 0, 0}, 1, -k_pressure);
    }
    CHECK(point.state[Law::plastic_strain] > 1e-2);
    CHECK(gap_of(point) == 0);
    point.strain({2e-3, 2e-3, 2e-3, 0, 0, 0});
    const double gap = gap_of(point);
    CHECK(gap > 5e-3);
    for (int n = 0; n < 100; ++n) point.strain({0, 0, 0, 1e-4, 0, 0});
    CHECK(std::fabs(gap_of(point) - gap) < 1e-12);
  };
  check(law_of<MohrCoulomb<double>>(soil(0, 15, k_no_tension)));
  check(law_of<DruckerPrager<double>>(cone(0, 15, k_no_tension)));
}

TEST_CASE("a crack bears along itself, and across itself once it has closed", "[parting]") {
  const auto check = [](const auto& law) {
    using Law = std::remove_cvref_t<decltype(law)>;
    const double young = law.young, poisson = law.poisson, plane = young / (1 - poisson * poisson);
    Point<Law, 3> point(law, {-1000, -3000, -1000, 0, 0, 0});
    for (int n = 0; n < 100; ++n) point.strain({1e-4, 0, 0, 0, 0, 0});
    CHECK(std::fabs(point.stress[0]) < 1e-6);
    const double open = gap_of(point), along = point.stress[1];
    CHECK(std::fabs(open - (1e-2 - 1000 / (young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))))) <
          1e-9);
    point.strain({0, -1e-5, 0, 0, 0, 0});  // stress across it stays, and that along it is of plane stress
    CHECK(std::fabs(point.stress[0]) < 1e-6);
    CHECK(std::fabs((point.stress[1] - along) / (-1e-5 * plane) - 1) < 1e-9);
    point.strain({0, 1e-5, 0, 0, 0, 0});
    CHECK(std::fabs(gap_of(point) / open - 1) < 1e-9);
    for (int n = 0; n < 98; ++n) {
      point.strain({-1e-4, 0, 0, 0, 0, 0});
      CHECK(std::fabs(point.stress[0]) < 1e-6);
    }
    point.strain({-2e-4, 0, 0, 0, 0, 0});
    CHECK(gap_of(point) == 0);
    CHECK(std::fabs(point.stress[0] + 1000) < 1e-3);
    CHECK(std::fabs(point.stress[1] + 3000) < 1e-3);
  };
  check(law_of<MohrCoulomb<double>>(soil(2e4, 0, 0)));
  check(law_of<Tresca<double>>(with(k_elastic, {{"su", 2e4}, {"tension", 0}})));
}

TEST_CASE("Cam-Clay without pressure closes its gap first", "[parting]") {
  const auto law = law_of<CamClay<double>>(k_clay);
  using Law = CamClay<double>;
  for (const int n : {200, 5000}) {
    Point<Law, 3> point(law, {-2e3, -2e3, -2e3, 0, 0, 0});
    const double part = 0.6 / 3 / n;
    for (int k = 0; k < n; ++k) point.strain({part, part, part, 0, 0, 0});
    CHECK(largest_stress(point) == 0);
    // ln(P / least) + 1 of elastic strain, at v / kappa = 100 and more, and a gap of the rest
    CHECK(std::fabs(gap_of(point) - (0.6 - (std::log(20) + 1) / 100)) < 1e-3);
    for (int k = 0; k < n; ++k) {
      point.strain({-part, -part, -part, 0, 0, 0});
      if (gap_of(point) > 0) CHECK(largest_stress(point) == 0);
    }
    CHECK(gap_of(point) == 0);
    CHECK(std::fabs(-mean_of(point.stress) / 2e3 - 1) < 0.02);
    CHECK(std::fabs(point.state[Law::specific_volume] / 2 - 1) < 1e-6);
  }
}

namespace {

/// Particles in lanes, of which some have a gap, close it and open it as one by one.
template <template <class> class Law>
void check_all_lanes(const Values& values) {
  for_each_lanes([&](auto real, auto dimension) {
    using T = decltype(real);
    using Particle = Point<Law<T>, dimension.value>;
    const auto law = law_of<Law<T>>(values);
    const auto begins = [&](Dice& dice, const Sym& start) {
      const bool open = dice.below(2) == 0;
      Particle particle(law, open ? Sym{} : start);
      if (open) particle.state[Law<T>::parted] = static_cast<T>(dice.uniform(0, 2e-3));
      return particle;
    };
    const LanesApart apart = lanes_apart<T, dimension.value>(law, 9, 1000, Law<T>::parted, begins,
                                                             [](const Particle&) { return false; });
    INFO(Law<T>::k_name << " " << dimension.value << "D, lanes " << native_lanes<T>);
    CHECK(apart.stress < (sizeof(T) == sizeof(double) ? 1e-9 : 0.1));
    CHECK(apart.state < (sizeof(T) == sizeof(double) ? 1e-15 : 1e-8));
  });
}

}  // namespace

TEST_CASE("particles many at once part as one by one", "[parting]") {
  check_all_lanes<MohrCoulomb>(soil(0, 10, k_no_tension));
  check_all_lanes<MohrCoulomb>(soil(300, 10, 50));
  check_all_lanes<DruckerPrager>(cone(300, 10, 50));
  check_all_lanes<Tresca>(with(k_elastic, {{"su", 400}, {"tension", 50}}));
}
