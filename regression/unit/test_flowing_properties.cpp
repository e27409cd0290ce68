// Properties of any state of mu_i, newtonian, yield_stress_fluid, power_elastic and j2_hardening: many
// random ones; and these laws on every back end, and in lanes of a processor.

#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"
#include "element.hpp"
#include "loops/cpu/host_particles.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Random parameters of a law, the same in each real type.
template <class Law>
Values roll(Dice& dice) {
  const auto power = [&](double low, double high) { return std::pow(10, dice.uniform(low, high)); };
  const double size = power(1, 6);  // Pa
  if constexpr (requires(Law law) { law.mu_static; }) {
    const double mu = dice.uniform(0.1, 0.7);
    return {{"young", size * power(1, 4)},
            {"poisson", dice.uniform(0, 0.45)},
            {"mu_static", mu},
            {"mu_dynamic", mu + dice.uniform(0.01, 0.6)},
            {"inertial_number", power(-2, 1)},
            {"grain_diameter", power(-5, -1)},
            {"grain_density", power(2, 4)}};
  } else if constexpr (requires(Law law) { law.viscosity; }) {
    return {{"bulk_modulus", size * power(0, 3)}, {"viscosity", dice.below(9) == 0 ? 0 : power(-3, 3)}};
  } else if constexpr (requires(Law law) { law.consistency; }) {
    const double n = dice.below(3) == 0 ? 1 : power(-1.2, 0.45);
    return {{"bulk_modulus", size * power(0, 3)},
            {"shear_modulus", size * power(1, 3)},
            {"yield_stress", dice.below(5) == 0 ? 0 : size},
            {"consistency", dice.below(9) == 0 ? 0 : size * power(-3, 2)},
            {"exponent", n},
            {"tension", dice.below(2)}};
  } else if constexpr (requires(Law law) { law.pressure_min; }) {
    return {{"bulk_modulus", size * power(1, 4)},  {"pressure_reference", size},
            {"exponent", dice.below(4) / 3.},      {"pressure_offset", dice.below(2) * size * 0.1},
            {"pressure_min", size * power(-4, 0)}, {"poisson", dice.uniform(-0.5, 0.49)}};
  } else {
    return {{"young", size * power(1, 4)},
            {"poisson", dice.uniform(0, 0.49)},
            {"yield_stress", size},
            {"hardening_modulus", dice.below(3) == 0 ? 0 : size * power(-1, 4)}};
  }
}

/// G [Pa] of what a law stores in shear; infinite where that is nothing.
template <class Law>
double shear_modulus_in(const Law& law) {
  if constexpr (requires { law.viscosity; }) return std::numeric_limits<double>::infinity();
  if constexpr (requires { law.shear_modulus; }) return law.shear_modulus;
  return 0;  // power_elastic: not one
}

/// The size of the stresses that a law can answer to this stress [Pa] and strain, for round-off.
template <class Law>
double size_of(const Law& law, const Point<Law, 3>& after, const Sym& start, const Sym& by, double dt) {
  double stress = 0, strain = 0;
  for (int k = 0; k < 6; ++k) {
    stress = std::fmax(stress, std::fmax(std::fabs(start[k]), std::fabs(after.stress[k])));
    strain = std::fmax(strain, std::fabs(by[k]));
  }
  const Point<Law, 3> before(law, start);
  stress +=
      std::fmax(law.wave_modulus(before.stress, before.state), law.wave_modulus(after.stress, after.state)) *
      strain;
  if constexpr (requires { law.viscosity; }) stress += law.viscosity * strain / dt;
  if constexpr (requires { law.pressure_min; })  // d X' / d X of a step from X to X'
    stress *= std::fmax(1.0, law.bulk_modulus_at(law.pressure_offset - mean_of(after.stress)) /
                                 law.bulk_modulus_at(law.pressure_offset - mean_stress(start)));
  return stress;
}

/// Modulus [Pa] that makes a stress of state variable k, a strain: the bulk modulus of a volume strain, which
/// may be far below the shear modulus.
template <class Law>
double modulus_of(const Law& law, const Point<Law, 3>& point, int k) {
  if constexpr (requires { law.bulk_modulus, Law::parted; })
    if (k == Law::parted) return law.bulk_modulus;
  return std::fmin(law.wave_modulus(point.stress, point.state), shear_modulus_in(law));
}

/// Worst of n random states of a law, relative to the size of the stress. `gains`: work of the
/// deviator on the strain that is not elastic, below 0.
struct Worst {
  double gains = 0, flat = 0, single = 0, state = 0;
  long flowing = 0, not_finite = 0;
};

template <template <class> class Law>
void try_state(const Law<double>& law, const Law<float>& rough_law, const Sym& start, const Sym& by,
               double dt, Worst& worst) {
  Point<Law<double>, 3> point(law, start);
  point.strain(by, dt);
  const double size = size_of(law, point, start, by, dt);
  const auto keep = [size](double& most, double value) { most = std::fmax(most, value / size); };
  const double mean = mean_of(point.stress), third = (by[0] + by[1] + by[2]) / 3;
  if (const double modulus = shear_modulus_in(law); modulus > 0) {
    double work = 0, largest = 0;
    for (int k = 0; k < 6; ++k) {
      const double s = point.stress[k] - (k < 3 ? mean : 0),
                   old = start[k] - (k < 3 ? mean_stress(start) : 0);
      const double flow = by[k] - (k < 3 ? third : 0) - (s - old) / (2 * modulus);
      work += (k < 3 ? 1 : 2) * s * flow;
      largest = std::fmax(largest, std::fabs(by[k]) + std::fabs(old) / modulus);
    }
    if (largest > 0) keep(worst.gains, -work / largest);
  }
  Point<Law<double>, 2> flat(law, start);
  flat.strain(by, dt);
  for (int k = 0; k < 4 && by[4] == 0 && by[5] == 0 && start[4] == 0 && start[5] == 0; ++k)
    keep(worst.flat, std::fabs(flat.stress[k] - point.stress[k]));
  Point<Law<float>, 3> rough(rough_law, start);
  rough.strain(by, dt);
  bool finite = true;
  for (int k = 0; k < 6; ++k) {
    finite &= std::isfinite(point.stress[k]) && std::isfinite(rough.stress[k]);
    keep(worst.single, std::fabs(rough.stress[k] - point.stress[k]));
  }
  for (int k = 0; k < point.state.size && carries(law, k); ++k) {
    finite &= std::isfinite(point.state[k]) && std::isfinite(rough.state[k]);
    keep(worst.state, std::fabs(double(rough.state[k]) - point.state[k]) * modulus_of(law, point, k));
  }
  worst.flowing += point.state.size > 0 && point.state[0] > 0;
  worst.not_finite += !finite;
}

template <template <class> class Law>
Worst try_states(long n, int seed) {
  Dice dice{std::mt19937_64(seed)};
  Worst worst;
  for (long k = 0; k < n;) {
    const Values values = roll<Law<double>>(dice);
    const auto law = law_of<Law<double>>(values);
    const auto rough = law_of<Law<float>>(values);
    const double stress = values[0].second * std::pow(10, dice.uniform(-4, -2));
    for (int same = 0; same < 50 && k < n; ++same, ++k) {
      const bool flat = dice.below(2) == 0;
      Sym start = random_sym(dice, dice.below(20) == 0 ? 0 : stress, flat);
      const double lower = dice.uniform(-1, 3) * stress;  // mostly compression
      for (int d = 0; d < 3; ++d) start[d] -= lower;
      Sym by = random_sym(dice, dice.below(50) == 0 ? 0.2 : std::pow(10, dice.uniform(-7, -2)), flat);
      if (flat) by[2] = 0;
      try_state<Law>(law, rough, start, by, std::pow(10, dice.uniform(-6, -3)), worst);
    }
  }
  return worst;
}

template <template <class> class Law>
void check_states(long n, int seed) {
  const Worst worst = try_states<Law>(n, seed);
  CAPTURE(Law<double>::k_name, worst.gains, worst.flat, worst.single, worst.state, worst.flowing);
  CHECK(worst.not_finite == 0);
  CHECK(worst.gains < 1e-13);
  CHECK(worst.flat < 1e-13);
  CHECK(worst.single < 5e-6);
  CHECK(worst.state < 3e-5);
  if (state_size<Law<double>> == 0) return;
  CHECK(worst.flowing > n / 5);
  CHECK(worst.flowing < n * 49 / 50);
}

/// How many numbers are not finite after a step from stresses and strains of any size.
template <class Law, int Dim>
int not_finite_of(const Values& values) {
  int bad = 0;
  const auto law = law_of<Law>(values);
  for (double size = 1e-42; size < 1e14; size *= 10)
    for (const Sym& form : {Sym{1, 1, 1, 0, 0, 0}, Sym{-1, -1, -1, 0, 0, 0}, Sym{1, -1, 0, 0, 0, 0},
                            Sym{1, 1, 1, 1, 1, 1}, Sym{0, 0, 0, 1, -1, 0}, Sym{-1, 0.5, 0.5, 1e-9, 0, 1e-20}})
      for (const double strain : {0., 1e-42, 1e-20, 1e-3, 0.2})
        for (const Sym& by : {Sym{1, 1, 1, 0, 0, 0}, Sym{-1, -1, -1, 0, 0, 0}, Sym{1, -1, 0, 1, -1, 1}})
          for (const double dt : {1e-9, 1e-4, 1.}) {
            Sym start = form, increment = by;
            for (int k = 0; k < 6; ++k) start[k] *= size, increment[k] *= strain;
            Point<Law, Dim> point(law, start);
            point.strain(increment, dt), point.strain({}, dt);
            for (const auto& x : point.stress.c) bad += !std::isfinite(x);
            for (int k = 0; k < point.state.size; ++k) bad += !std::isfinite(point.state[k]);
          }
  return bad;
}

template <template <class> class Law>
void check_finite(int seed) {
  Dice dice{std::mt19937_64(seed)};
  int bad = 0;
  for (int n = 0; n < 20; ++n) {
    const Values values = roll<Law<double>>(dice);
    bad += not_finite_of<Law<double>, 2>(values) + not_finite_of<Law<double>, 3>(values) +
           not_finite_of<Law<float>, 2>(values) + not_finite_of<Law<float>, 3>(values);
  }
  INFO(Law<double>::k_name);
  CHECK(bad == 0);
}

/// Calls f(law template holder, seed) for the five laws.
template <template <class> class Law>
struct Kind {
  template <class T>
  using of = Law<T>;
};
template <class F>
void for_each_law(const F& f) {
  f(Kind<MuI>{}, 1), f(Kind<Newtonian>{}, 2), f(Kind<YieldStressFluid>{}, 3), f(Kind<PowerElastic>{}, 4),
      f(Kind<J2Hardening>{}, 5);
}

/// Random stresses after a step in lanes, where all yield or only some, are those of the particles one by
/// one.
template <class Law, int Dim>
void check_lanes(const Law& law, Dice& dice, double stress_size, double strain_size) {
  using T = typename Law::real;
  constexpr int W = native_lanes<T>, N = state_size<Law>;
  using R = Lanes<T, W>;
  double apart = 0, largest = 0;
  for (int block = 0; block < 200; ++block) {
    SymTensor<R, Dim> stress;
    LawState<R, N> state;
    Increment<R, T, Dim> increment{};
    increment.dt = T(1e-5);
    std::vector<Point<Law, Dim>> right;
    for (int l = 0; l < W; ++l) {
      const Sym start = random_sym(dice, stress_size, Dim == 2), by = random_sym(dice, strain_size, Dim == 2);
      right.emplace_back(law, start);
      for (int k = 0; k < sym_size<Dim>; ++k) {
        stress[k].set(l, right[l].stress[k]);
        increment.strain[k].set(l, static_cast<T>(by[k]));
      }
      for (int k = 0; k < N; ++k) state[k].set(l, right[l].state[k]);
      right[l].strain(by, 1e-5);
    }
    update_lanes(
        law, stress, state, increment, [](int) { return true; }, [](int) { return ParticlePlace{}; });
    for (int l = 0; l < W; ++l) {
      for (int k = 0; k < sym_size<Dim>; ++k) {
        apart = std::fmax(apart, std::fabs(double(stress[k][l]) - right[l].stress[k]));
        largest = std::fmax(largest, std::fabs(right[l].stress[k]));
      }
      for (int k = 0; k < N; ++k)
        apart =
            std::fmax(apart, std::fabs(double(state[k][l]) - right[l].state[k]) * stress_size / strain_size);
    }
  }
  INFO(Law::k_name << " " << Dim << "D, lanes " << W);
  CHECK(apart < (sizeof(T) == sizeof(double) ? 1e-13 : 1e-4) * largest);
}

}  // namespace

TEST_CASE("random states of flowing laws dissipate, and agree in 2D, 3D and single precision",
          "[flowing_laws]") {
  for_each_law([](auto kind, int seed) { check_states<decltype(kind)::template of>(100000, seed); });
}

TEST_CASE("no finite input of a flowing law gives a number that is not finite", "[flowing_laws]") {
  for_each_law([](auto kind, int seed) { check_finite<decltype(kind)::template of>(seed); });
}

TEST_CASE("particles many at once flow as one by one", "[flowing_laws]") {
  for_each_law([](auto kind, int seed) {
    using K = decltype(kind);
    Dice dice{std::mt19937_64(seed + 20)};
    for (int n = 0; n < 20; ++n) {
      const Values values = roll<typename K::template of<double>>(dice);
      const double stress = values[0].second * 1e-3;
      check_lanes<typename K::template of<double>, 2>(law_of<typename K::template of<double>>(values), dice,
                                                      stress, 1e-3);
      check_lanes<typename K::template of<double>, 3>(law_of<typename K::template of<double>>(values), dice,
                                                      stress, 1e-3);
      check_lanes<typename K::template of<float>, 3>(law_of<typename K::template of<float>>(values), dice,
                                                     stress, 1e-3);
    }
  });
}
