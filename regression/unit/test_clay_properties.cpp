// Properties of any state of cam_clay and softening_clay: many random ones.

#include <catch2/catch_test_macros.hpp>

#include "element.hpp"
#include "physics/materials/cam_clay.hpp"
#include "physics/materials/softening_clay.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Worst of n random states of a law, over the largest stress of the state.
struct Worst {
  double outside = 0, outside_single = 0, gains = 0, flat = 0, single = 0, single_state = 0;
  long yielding = 0, elastic_changed = 0, not_finite = 0, far_outside = 0;
};

template <class P>
bool is_finite(const P& point) {
  double sum = 0;
  for (const auto& x : point.stress.c) sum += 0 * double(x);
  for (const auto& x : point.state.c) sum += 0 * double(x);
  return sum == 0;
}

/// A law with random parameters, a stress inside of its surface, and an increment of strain.
struct State {
  Values values;
  Sym start{}, by{};
  double size;  // Pa
  bool flat;
};

Sym deviator_of(const Sym& s) {
  const double mean = mean_stress(s);
  return {s[0] - mean, s[1] - mean, s[2] - mean, s[3], s[4], s[5]};
}
double product(const Sym& a, const Sym& b) {
  double sum = 0;
  for (int k = 0; k < 6; ++k) sum += (k < 3 ? 1 : 2) * a[k] * b[k];
  return sum;
}
template <class P>
Sym stress_of(const P& point) {
  Sym s{};
  for (std::size_t k = 0; k < std::size(point.stress.c); ++k) s[k] = point.stress[k];
  return s;
}

/// A deviator of q = sqrt(3 J2) = 1.
Sym unit_deviator(Dice& dice, bool flat) {
  Sym s = deviator_of(random_sym(dice, 1, flat));
  const double q = std::sqrt(1.5 * product(s, s));
  for (double& x : s) x = q > 0 ? x / q : 0;
  return s;
}

State cam_clay_state(Dice& dice) {
  State of;
  of.flat = dice.below(2) == 0;
  of.size = std::pow(10, dice.uniform(2, 6));
  const double m = dice.uniform(0.4, 1.7), lambda = dice.uniform(0.05, 0.4), pc = of.size,
               part = dice.uniform(0.02, 1);
  of.values = {{"critical_state_ratio", m},
               {"lambda", lambda},
               {"kappa", lambda * dice.uniform(0.1, 0.5)},
               {"specific_volume", dice.uniform(1.2, 3)},
               {"preconsolidation", pc},
               {"pressure_min", pc * std::pow(10, dice.uniform(-5, -2))}};
  if (dice.below(2) == 0)
    of.values.push_back({"shear_modulus", pc * dice.uniform(5, 50)});
  else
    of.values.push_back({"poisson", dice.uniform(0, 0.45)});
  const double p = part * pc, q = m * std::sqrt(p * (pc - p)) * (dice.below(3) == 0 ? 1 : dice.uniform(0, 1));
  of.start = unit_deviator(dice, of.flat);
  for (int k = 0; k < 6; ++k) of.start[k] = q * of.start[k] - (k < 3 ? p : 0);
  of.by = random_sym(dice, std::pow(10, dice.uniform(-7, -3.9)), of.flat);
  if (of.flat) of.by[2] = 0;
  return of;
}

State softening_state(Dice& dice) {
  State of;
  of.flat = dice.below(2) == 0;
  of.size = std::pow(10, dice.uniform(2, 6));
  const double young = of.size * std::pow(10, dice.uniform(2, 3.5)), ratio = dice.uniform(0.05, 1);
  of.values = {{"young", young},
               {"poisson", dice.uniform(0, 0.49)},
               {"su", of.size},
               {"remoulded_ratio", ratio},
               {"xi95", std::pow(10, dice.uniform(0, 2))},
               {"rate_factor", dice.uniform(0, 0.2)},
               {"rate_reference", 1e-2},
               {"surface", dice.below(2)}};
  of.start = unit_deviator(dice, of.flat);
  const double p = of.size * dice.uniform(-3, 3), q = of.size * dice.uniform(0, 1);
  for (int k = 0; k < 6; ++k) of.start[k] = q * of.start[k] - (k < 3 ? p : 0);
  of.by = random_sym(dice, of.size / young * std::pow(10, dice.uniform(-2, 1.5)), of.flat);
  if (of.flat) of.by[2] = 0;
  return of;
}

/// f/Pc^2 of Cam-Clay, and how far sqrt(J2) or s1 - s3 is beyond the strength of softening clay, over the
/// strength.
template <class P>
double outside_of(const CamClay<double>& law, const P& point, const P&, const Sym&) {
  const Sym s = stress_of(point);
  const double pc = point.state[0], p = -mean_stress(s) / pc;
  return 1.5 * product(deviator_of(s), deviator_of(s)) / std::pow(law.critical_state_ratio * pc, 2) +
         p * (p - 1);
}
template <class P>
double outside_of(const SofteningClay<double>& law, const P& point, const P& before, const Sym& by) {
  const Sym e = deviator_of(by);
  const double rate = std::fmax(1, std::sqrt(2 * product(e, e)) / law.rate_reference);
  const double xi = law.surface == 1 ? double(before.state[0]) : double(point.state[0]),
               d = law.remoulded_ratio;
  const double su =
      law.su * (d + (1 - d) * std::exp(-3 * xi / law.xi95)) * (1 + law.rate_factor * std::log10(rate));
  const Sym s = stress_of(point);
  if (law.surface == 0) return std::sqrt(product(deviator_of(s), deviator_of(s)) / 2) / su - 1;
  const SymTensor<double, 3> wide{s[0], s[1], s[2], s[3], s[4], s[5]};
  const auto sorted = sorted_down(principal_of(wide, mean_of(wide)).value);
  return (sorted.value[0] - sorted.value[2]) / (2 * su) - 1;
}

/// Plastic work of a step [J/m3], from the stress and state before and after; s : de_p of the deviator, and P
/// de_v^p.
using Clay3 = Point<CamClay<double>, 3>;
double plastic_work(const CamClay<double>& law, const Clay3& after, const Clay3& before, const Sym& by) {
  const double dv = -(by[0] + by[1] + by[2]), v = before.state[1] * std::exp(-dv / 2), a = v / law.kappa;
  const double p0 = -mean_stress(stress_of(before)), p1 = -mean_stress(stress_of(after));
  const double rise = ElasticPressure<double>{law.least}.change(p0, a * dv);
  const double bulk = a * std::fmax(law.least, p0 + rise / 2), nu = law.poisson;
  const double shear =
      law.shear_modulus > 0 ? double(law.shear_modulus) : bulk * 3 * (1 - 2 * nu) / (2 * (1 + nu));
  const double x = std::log(after.state[0] / before.state[0]) * (law.lambda - law.kappa) / v;
  const Sym s1 = deviator_of(stress_of(after)), s0 = deviator_of(stress_of(before));
  Sym plastic = deviator_of(by);
  for (int k = 0; k < 6; ++k) plastic[k] -= (s1[k] - s0[k]) / (2 * shear);
  return product(s1, plastic) + p1 * x;
}
using Soft3 = Point<SofteningClay<double>, 3>;
double plastic_work(const SofteningClay<double>& law, const Soft3& after, const Soft3& before,
                    const Sym& by) {
  const double shear = shear_modulus_of(law.young, law.poisson);
  const Sym s1 = deviator_of(stress_of(after)), s0 = deviator_of(stress_of(before));
  Sym plastic = deviator_of(by);
  for (int k = 0; k < 6; ++k) plastic[k] -= (s1[k] - s0[k]) / (2 * shear);
  return product(s1, plastic);
}

template <template <class> class Law>
void try_state(const State& of, Worst& worst) {
  const auto law = law_of<Law<double>>(of.values);
  const Point<Law<double>, 3> before(law, of.start);
  auto point = before;
  point.strain(of.by);
  double size = of.size, strain = 1e-30;
  for (int k = 0; k < 6; ++k) size = std::fmax(size, std::fabs(double(point.stress[k])));
  for (const double e : of.by) strain = std::fmax(strain, std::fabs(e));
  const auto keep = [](double& most, double value) { most = std::fmax(most, value); };
  const bool yields = point.state[0] != before.state[0];
  worst.yielding += yields;
  const double outside = outside_of(law, point, before, of.by);
  keep(worst.outside, outside);
  worst.far_outside += outside > 1e-8;
  if (yields) keep(worst.gains, -plastic_work(law, point, before, of.by) / (size * strain));

  Point<Law<float>, 3> rough(law_of<Law<float>>(of.values), of.start);
  rough.strain(of.by);
  for (int k = 0; k < 6; ++k) keep(worst.single, std::fabs(rough.stress[k] - point.stress[k]) / size);
  keep(worst.single_state, std::fabs(rough.state[0] / std::fmax(1.0, point.state[0]) -
                                     point.state[0] / std::fmax(1.0, point.state[0])));
  worst.not_finite += !is_finite(point) || !is_finite(rough);
  if (!of.flat) return;
  Point<Law<double>, 2> in_plane(law, of.start);
  in_plane.strain(of.by);
  for (int k = 0; k < 4; ++k) keep(worst.flat, std::fabs(in_plane.stress[k] - point.stress[k]) / size);
  keep(worst.flat, std::fabs(in_plane.state[0] - point.state[0]) / std::fmax(1.0, point.state[0]));
}

template <template <class> class Law>
Worst try_states(long n, int seed, State (*state)(Dice&)) {
  Dice dice{std::mt19937_64(seed)};
  Worst worst;
  for (long k = 0; k < n; ++k) try_state<Law>(state(dice), worst);
  return worst;
}

/// How many values after steps from stresses of any size are not finite.
template <class Law, int Dim>
int not_finite_of(const Values& values) {
  int bad = 0;
  const auto law = law_of<Law>(values);
  for (double size = 1e-42; size < 1e14; size *= 10)
    for (const Sym& form : {Sym{1, 1, 1, 0, 0, 0}, Sym{-1, -1, -1, 0, 0, 0}, Sym{1, -1, 0, 0, 0, 0},
                            Sym{1, 1, 1, 1, 1, 1}, Sym{0, 0, 0, 1, -1, 0}, Sym{-1, 0.5, 0.5, 1e-9, 0, 1e-20}})
      for (const double strain : {0., 1e-42, 1e-20, 1e-7, 1e-4, 1e-3, 0.2})
        for (const Sym& by : {Sym{1, 1, 1, 0, 0, 0}, Sym{-1, -1, -1, 0, 0, 0}, Sym{1, -1, 0, 1, -1, 1}}) {
          Sym start = form, increment = by;
          for (int k = 0; k < 6; ++k) start[k] *= size, increment[k] *= strain;
          Point<Law, Dim> point(law, start);
          point.strain(increment);
          point.strain({});
          point.strain(increment);
          bad += !is_finite(point);
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

TEST_CASE("random states of Cam-Clay", "[clay_laws]") {
  constexpr long n = 100000;
  const Worst worst = try_states<CamClay>(n, 31, cam_clay_state);
  CAPTURE(worst.outside, worst.far_outside, worst.gains, worst.flat, worst.single, worst.single_state,
          worst.yielding);
  CHECK(worst.not_finite == 0);
  CHECK(worst.outside < 1e-4);
  CHECK(worst.far_outside < n / 1000);
  CHECK(worst.gains < 1e-9);
  CHECK(worst.flat < 1e-11);
  CHECK(worst.single < 1e-4);
  CHECK(worst.single_state < 1e-4);
  CHECK(worst.yielding > n / 10);
  CHECK(worst.yielding < n * 9 / 10);
}

TEST_CASE("random states of softening clay", "[clay_laws]") {
  constexpr long n = 100000;
  const Worst worst = try_states<SofteningClay>(n, 32, softening_state);
  CAPTURE(worst.outside, worst.gains, worst.flat, worst.single, worst.single_state, worst.yielding);
  CHECK(worst.not_finite == 0);
  CHECK(worst.outside < 1e-10);
  CHECK(worst.gains < 1e-9);
  CHECK(worst.flat < 1e-12);
  CHECK(worst.single < 1e-5);
  CHECK(worst.single_state < 1e-5);
  CHECK(worst.yielding > n / 4);
  CHECK(worst.yielding < n * 9 / 10);
}

TEST_CASE("no finite stress and strain give a number of a clay that is not finite", "[clay_laws]") {
  Values clay{{"critical_state_ratio", 1}, {"lambda", 0.2},        {"kappa", 0.04},
              {"poisson", 0.25},           {"specific_volume", 2}, {"ocr", 1}};
  check_finite<CamClay>(clay);
  clay.push_back({"pressure_min", 1e-6});
  check_finite<CamClay>(clay);
  for (const double surface : {0., 1.})
    check_finite<SofteningClay>({{"young", 5e5},
                                 {"poisson", 0.49},
                                 {"su", 1000},
                                 {"remoulded_ratio", 0.2},
                                 {"xi95", 10},
                                 {"rate_factor", 0.1},
                                 {"rate_reference", 1e-3},
                                 {"surface", surface}});
}

TEST_CASE("the safeguard of Cam-Clay's return finds what Newton's method finds", "[clay_laws]") {
  Dice dice{std::mt19937_64(33)};
  double apart = 0;
  int converged = 0;
  for (int n = 0; n < 10000; ++n) {
    const double p = dice.uniform(0.05, 1.2), m = dice.uniform(0.5, 1.5), v = 2, kappa = 0.04, lambda = 0.2;
    const double q = m * std::sqrt(std::fmax(0.0, p * (1 - p))) + dice.uniform(1e-4, 1e-2);
    const CamClayReturn<double> back{{1e-4}, p, 0,      v / kappa,  v / (lambda - kappa),
                                     q,      p, 30 * p, 1 / (m * m)};
    double l, x;
    back.iterate(true, l, x);
    const auto [safe_l, safe_x] = bisected(back);
    if (std::fabs(back.at(l, x).of_f) < 1e-12)
      ++converged, apart = std::fmax(apart, std::fabs(safe_x - x) + std::fabs(safe_l / l - 1));
    CHECK(std::fabs(back.at(safe_l, safe_x).of_f) < 1e-10);
    CHECK(std::fabs(back.at(safe_l, safe_x).of_x) < 1e-12);
  }
  CHECK(apart < 1e-7);
  CHECK(converged > 9000);
}
