// Properties of any state of tresca, mohr_coulomb and drucker_prager: many random ones.

#include <catch2/catch_test_macros.hpp>
#include <limits>

#include "clouds.hpp"
#include "element.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A law with random parameters, the same in each real type.
struct RandomSoil {
  Values values;
  double strength;  // Pa, the scale of the yield surface

  template <template <class> class Law>
  static RandomSoil roll(Dice& dice) {
    const double strength = std::pow(10, dice.uniform(2, 6));
    RandomSoil soil{
        {{"young", strength * std::pow(10, dice.uniform(2, 3.5))}, {"poisson", dice.uniform(0, 0.49)}},
        strength};
    const auto give = [&](const char* key, double value) { soil.values.push_back({key, value}); };
    if (dice.below(2) == 0) give("tension", dice.below(3) == 0 ? 0 : strength * dice.uniform(0, 2));
    if constexpr (requires(Law<double> law) { law.su; }) {
      give("su", strength);
    } else {
      const double friction = dice.below(8) == 0 ? 0 : dice.uniform(2, 45);
      give("friction_deg", friction);
      give("dilation_deg", dice.below(3) == 0 ? friction : dice.uniform(0, friction));
      give("cohesion", friction > 0 && dice.below(5) == 0 ? 0 : strength);
    }
    if constexpr (requires(Law<double> law) { law.match; }) give("match", dice.below(3));
    return soil;
  }
};

/// How far outside of the yield surface of a material point its stress is, in double [Pa].
double outside_of(const Tresca<double>& law, double su, const SymTensor<double, 3>& s) {
  const auto sorted = sorted_down(principal_of(s, mean_of(s)).value);
  const double yield = sorted.value[0] - sorted.value[2] - 2 * su;
  return law.tension >= 0 ? std::fmax(yield, sorted.value[0] + mean_of(s) - law.tension) : yield;
}
double outside_of(const MohrCoulomb<double>& law, double c, const SymTensor<double, 3>& s) {
  const double phi = law.friction_deg * std::acos(-1.) / 180, mean = mean_of(s);
  const auto sorted = sorted_down(principal_of(s, mean).value);
  const double s1 = sorted.value[0] + mean, s3 = sorted.value[2] + mean;
  const double yield = (s1 - s3) / 2 + (s1 + s3) / 2 * std::sin(phi) - c * std::cos(phi);
  return law.tension >= 0 ? std::fmax(yield, s1 - law.tension) : yield;
}
double outside_of(const DruckerPrager<double>& law, double c, const SymTensor<double, 3>& s) {
  const double mean = mean_of(s);
  const double yield =
      std::sqrt(second_invariant(s, mean)) + law.slope * mean - law.strength_over_cohesion * c;
  return law.tension >= 0 ? std::fmax(yield, mean - law.tension) : yield;
}

template <class T, int Dim>
SymTensor<double, 3> widened(const SymTensor<T, Dim>& s) {
  SymTensor<double, 3> wide{};
  for (int k = 0; k < sym_size<Dim>; ++k) wide[k] = s[k];
  return wide;
}

/// Worst of n random states of a law, relative to the stress of the trial (energies: to that of the
/// trial). `gains`: energy from plastic flow. `nearer`: with associated flow the return is the admissible
/// stress that is nearest to the trial in the elastic energy, so that (trial - s) : C^-1 (q - s) <= 0 for
/// each admissible q, which is taken from another return.
struct Worst {
  double outside = 0, outside_single = 0, gains = 0, nearer = 0, flat = 0, single = 0, strain = 0;
  long yielding = 0, associated = 0, elastic_changed = 0, not_finite = 0;
};

/// Stress increment of elasticity alone.
template <class Law>
SymTensor<double, 3> trial_of(const Law& law, const Sym& start, const Sym& by) {
  SymTensor<double, 3> s{{start[0], start[1], start[2], start[3], start[4], start[5]}}, e{};
  for (int k = 0; k < 6; ++k) e[k] = by[k];
  const double young = law.young, poisson = law.poisson;
  add_elastic(s, e, lame_of(young, poisson), shear_modulus_of(young, poisson));
  return s;
}

/// a : C^-1 b [J/m3] of two stresses.
template <class Law>
double complementary(const Law& law, const SymTensor<double, 3>& a, const SymTensor<double, 3>& b) {
  const double twice_g = 2 * shear_modulus_of<double>(law.young, law.poisson);
  const double volume = law.poisson / (1 + law.poisson) * 3 * mean_of(b);
  double sum = 0;
  for (int k = 0; k < 6; ++k) sum += (k < 3 ? 1 : 2) * a[k] * (b[k] - (k < 3 ? volume : 0)) / twice_g;
  return sum;
}

SymTensor<double, 3> difference(const SymTensor<double, 3>& a, const SymTensor<double, 3>& b) {
  SymTensor<double, 3> d;
  for (int k = 0; k < 6; ++k) d[k] = a[k] - b[k];
  return d;
}

/// Whether two stresses are the same sums, which the compiler may contract differently; size: of the largest
/// of their parts [Pa].
bool same_sums(const SymTensor<double, 3>& a, const SymTensor<double, 3>& b, double size) {
  constexpr double k_round_off = 8 * std::numeric_limits<double>::epsilon();
  bool same = true;
  for (int k = 0; k < 6; ++k) same = same && std::fabs(a[k] - b[k]) <= k_round_off * size;
  return same;
}

/// Whether flow is by the gradient of the yield function: the angles are one.
template <class Law>
bool is_associated(const Law& law) {
  if constexpr (requires { law.dilation_deg; }) return law.dilation_deg == law.friction_deg;
  return true;
}

/// A stress after a return, and the size of its trial [Pa], to whose round-off it is admissible.
struct Returned {
  SymTensor<double, 3> stress;
  double size;
};

template <template <class> class Law>
void try_state(const Law<double>& law, const Law<float>& single, const Sym& start, const Sym& by,
               double strength, bool flat, Returned& other, Worst& worst) {
  using D = Point<Law<double>, 3>;
  D point(law, start);
  point.strain(by);
  const auto trial = trial_of(law, start, by);
  double size = strength;
  for (int k = 0; k < 6; ++k) size = std::fmax(size, std::fabs(trial[k]));
  bool finite = std::isfinite(point.state[0]);
  for (const double x : point.stress.c) finite &= std::isfinite(x);
  const auto keep = [size](double& most, double value) { most = std::fmax(most, value / size); };
  keep(worst.outside, outside_of(law, point.state[1], point.stress));
  const bool yields = outside_of(law, point.state[1], trial) > 1e-12 * size;
  worst.yielding += yields;
  if (outside_of(law, point.state[1], trial) < -1e-12 * size) {
    double largest = size;
    for (int k = 0; k < 6; ++k) largest = std::fmax(largest, std::fabs(start[k]));
    worst.elastic_changed += point.state[0] != 0 || !same_sums(point.stress, trial, largest);
  }
  const double modulus = law.young;
  const auto beyond = difference(trial, point.stress);
  keep(worst.gains, -complementary(law, point.stress, beyond) * modulus / size);
  if (is_associated(law)) {
    ++worst.associated;
    const double both = std::fmax(size, other.size);
    keep(worst.nearer, complementary(law, difference(other.stress, point.stress), beyond) * modulus / both);
  }
  other = {point.stress, size};
  if (flat) {
    Point<Law<double>, 2> in_plane(law, start);
    in_plane.strain(by);
    for (int k = 0; k < 4; ++k) keep(worst.flat, std::fabs(in_plane.stress[k] - point.stress[k]));
    keep(worst.flat, std::fabs(in_plane.state[0] - point.state[0]) * modulus);
  }
  Point<Law<float>, 3> rough(single, start);
  rough.strain(by);
  for (int k = 0; k < 6; ++k) {
    finite &= std::isfinite(rough.stress[k]);
    keep(worst.single, std::fabs(rough.stress[k] - point.stress[k]));
  }
  keep(worst.strain, std::fabs(rough.state[0] - point.state[0]) * modulus);
  keep(worst.outside_single, outside_of(law, point.state[1], widened(rough.stress)));
  worst.not_finite += !finite;
}

template <template <class> class Law>
Worst try_states(long n, int seed) {
  Dice dice{std::mt19937_64(seed)};
  Worst worst;
  for (long k = 0; k < n;) {
    const RandomSoil soil = RandomSoil::roll<Law>(dice);
    const auto law = law_of<Law<double>>(soil.values);
    const auto single = law_of<Law<float>>(soil.values);
    Returned other{};
    if (outside_of(law, law.initial_state({})[1], other.stress) > 0)
      throw std::runtime_error("no stress is not admissible");
    for (int same = 0; same < 50 && k < n; ++same, ++k) {
      const bool flat = dice.below(2) == 0;
      const double size = soil.strength * std::pow(10, dice.uniform(-2, 2));
      const Sym start = random_sym(dice, dice.below(20) == 0 ? 0 : size, flat);
      Sym by = random_sym(dice, dice.below(50) == 0 ? 0.2 : size / law.young, flat);
      if (flat) by[2] = 0;
      try_state<Law>(law, single, start, by, soil.strength, flat, other, worst);
    }
  }
  return worst;
}

template <template <class> class Law>
void check_states(long n, int seed) {
  const Worst worst = try_states<Law>(n, seed);
  CAPTURE(Law<double>::k_name, worst.outside, worst.outside_single, worst.gains, worst.nearer, worst.flat,
          worst.single, worst.strain, worst.yielding);
  CHECK(worst.not_finite == 0);
  CHECK(worst.elastic_changed == 0);
  CHECK(worst.outside < 1e-14);
  CHECK(worst.outside_single < 5e-6);
  CHECK(worst.gains < 1e-13);
  CHECK(worst.nearer < 1e-13);
  CHECK(worst.associated > n / 4);
  CHECK(worst.flat < 1e-13);
  CHECK(worst.single < 3e-5);
  CHECK(worst.strain < 1e-5);
  CHECK(worst.yielding > n / 3);
  CHECK(worst.yielding < n * 19 / 20);
}

}  // namespace

TEST_CASE("random states return to the yield surface, dissipate, and agree in 2D, 3D and single precision",
          "[frictional_laws]") {
  check_states<Tresca>(100000, 1);
  check_states<MohrCoulomb>(100000, 2);
  check_states<DruckerPrager>(100000, 3);
}

TEST_CASE("a million random states of each frictional law", "[frictional_laws][.long]") {
  check_states<Tresca>(1000000, 11);
  check_states<MohrCoulomb>(1000000, 12);
  check_states<DruckerPrager>(1000000, 13);
}
