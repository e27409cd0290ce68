// cam_clay and softening_clay in lanes of a processor.

#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <limits>

#include "clouds.hpp"
#include "element.hpp"
#include "loops/cpu/host_particles.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const Values k_cam_clay{{"critical_state_ratio", 1}, {"lambda", 0.2}, {"kappa", 0.04},      {"poisson", 0.25},
                        {"specific_volume", 2},      {"ocr", 1.2},    {"pressure_min", 100}};
const Values k_softening{{"young", 5e5},           {"poisson", 0.45},  {"su", 1000},
                         {"remoulded_ratio", 0.2}, {"xi95", 10},       {"rate_factor", 0.1},
                         {"rate_reference", 1e-3}, {"rate_time", 0.01}};

/// Particles of a law, one a lane, some of which are no particles of the law and must not matter.
template <class T, int Dim, template <class> class Law>
struct Block {
  static constexpr int W = native_lanes<T>, N = state_size<Law<T>>;
  using R = Lanes<T, W>;
  static constexpr double k_dt = 1e-3;  // s
  SymTensor<R, Dim> stress;
  LawState<R, N> state;
  Increment<R, T, Dim> increment{};
  std::vector<Point<Law<T>, Dim>> right;
  bool active[W];

  /// At random stresses [Pa] about a pressure, and one in four near none.
  Block(Dice& dice, const Law<T>& law, double pressure) {
    for (int l = 0; l < W; ++l) {
      Sym start = random_sym(dice, 1000, Dim == 2);
      for (int k = 0; k < 3; ++k) start[k] -= pressure;
      right.emplace_back(law, start);
      active[l] = l == W / 2 || dice.below(5) > 0;
      const bool near_none = pressure > 0 && dice.below(4) == 0;
      for (int k = 0; k < sym_size<Dim>; ++k) {
        if (near_none) right[l].stress[k] *= T(0.001);
        stress[k].set(l, active[l] ? right[l].stress[k] : std::numeric_limits<T>::quiet_NaN());
      }
      for (int k = 0; k < N; ++k) state[k].set(l, active[l] ? right[l].state[k] : T(0));
    }
    increment.dt = T(k_dt);
  }
  /// A step with random strains between 1e-6 and `largest`.
  void step(Dice& dice, const Law<T>& law, double largest) {
    for (int l = 0; l < W; ++l) {
      const Sym by = random_sym(dice, std::exp(dice.uniform(std::log(1e-6), std::log(largest))), Dim == 2);
      for (int k = 0; k < sym_size<Dim>; ++k) increment.strain[k].set(l, static_cast<T>(by[k]));
      right[l].strain(by, k_dt);
    }
    update_lanes(
        law, stress, state, increment, [&](int l) { return active[l]; }, [](int) { return ParticlePlace{}; });
  }
  /// Largest difference of an active lane from the particle alone, relative to a stress of 3000 Pa and to
  /// the state, or to 1e-3 where the state is less.
  double apart() const {
    double most = 0;
    const auto compare = [&](double got, double expected, double scale) {
      const double difference = got == expected ? 0 : std::fabs(got - expected) / scale;
      most = difference <= most ? most : difference;  // NaN counts
    };
    for (int l = 0; l < W; ++l) {
      if (!active[l]) continue;
      for (int k = 0; k < sym_size<Dim>; ++k) compare(stress[k][l], right[l].stress[k], 3000);
      for (int k = 0; k < N; ++k)
        if (Law<T>::state()[k].output || Law<T>::state()[k].parameter)
          compare(state[k][l], right[l].state[k], std::fmax(1e-3, std::fabs(right[l].state[k])));
    }
    return most;
  }
};

/// `happens(block, lane)`: what has to happen to some lanes, but not to all.
template <class T, int Dim, template <class> class Law, class Happens>
void check_lanes(const Values& values, double pressure, double largest, const Happens& happens) {
  using Lanes = Block<T, Dim, Law>;
  Dice dice{std::mt19937_64(17)};
  const auto law = law_of<Law<T>>(values);
  constexpr int k_blocks = 400, k_steps = 5;
  double apart = 0;
  int happened = 0;
  for (int n = 0; n < k_blocks; ++n) {
    Lanes block(dice, law, pressure);
    for (int step = 0; step < k_steps; ++step) block.step(dice, law, largest);
    const double of_block = block.apart();
    apart = of_block <= apart ? apart : of_block;
    for (int l = 0; l < Lanes::W; ++l) happened += happens(block.right[l]);
  }
  INFO(Law<T>::k_name << " " << Dim << "D, lanes " << Lanes::W << ", strains to " << largest);
  CHECK(apart < (sizeof(T) == sizeof(double) ? 1e-9 : 2e-3));
  CHECK(happened > k_blocks * Lanes::W / 100);
  CHECK(happened < k_blocks * Lanes::W * 99 / 100);
}

template <template <class> class Law, class Happens>
void check_all_lanes(const Values& values, double pressure, double largest, const Happens& happens) {
  check_lanes<double, 2, Law>(values, pressure, largest, happens);
  check_lanes<double, 3, Law>(values, pressure, largest, happens);
  check_lanes<float, 2, Law>(values, pressure, largest, happens);
  check_lanes<float, 3, Law>(values, pressure, largest, happens);
}

}  // namespace

TEST_CASE("clay in lanes strains as one by one", "[clay_laws]") {
  const auto yielded = [](const auto& point) { return point.state[0] > 0; };
  check_all_lanes<SofteningClay>(k_softening, 0, 2e-3, yielded);
  Values hexagon = k_softening;
  hexagon.push_back({"surface", SofteningClay<double>::tresca});
  check_all_lanes<SofteningClay>(hexagon, 0, 2e-3, yielded);
}

TEST_CASE("Cam-Clay in lanes strains as one by one", "[clay_laws]") {
  const auto has_no_stress = [](const auto& point) { return point.stress[0] == 0 && point.stress[1] == 0; };
  const auto failed = [](const auto& point) { return point.law.failed(point.state); };
  check_all_lanes<CamClay>(k_cam_clay, 3000, 1e-3, has_no_stress);  // several sub-increments in many lanes
  check_all_lanes<CamClay>(k_cam_clay, 3000, 3e-2, failed);         // too many in some
}
