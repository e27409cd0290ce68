#pragma once
// Laws in lanes of a processor against the same law one particle at a time.

#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <random>
#include <type_traits>
#include <vector>

#include "element.hpp"
#include "loops/cpu/host_laws.hpp"

namespace mpm::test {

/// How far blocks of random particles in lanes are from the particles one by one.
struct LanesApart {
  double stress = 0, state = 0;  // Pa, unit of the state that was asked for
  int particles = 0, counted = 0;
};

/// Strains blocks of random particles in lanes and one by one. begins(dice, particle, start): may change a
/// particle and its stress before; state: number of the state that is compared; counts(particle): whether a
/// particle counts, after.
template <class T, int Dim, class Law, class Begins, class Counts>
LanesApart lanes_apart(const Law& law, int seed, int blocks, int state_number, const Begins& begins,
                       const Counts& counts) {
  constexpr int W = native_lanes<T>;
  using R = Lanes<T, W>;
  Dice dice{std::mt19937_64(seed)};
  LanesApart apart;
  for (int block = 0; block < blocks; ++block) {
    SymTensor<R, Dim> stress;
    LawState<R, state_size<Law>> state;
    Increment<R, T, Dim> increment{};
    std::vector<Point<Law, Dim>> right;
    for (int l = 0; l < W; ++l) {
      const Sym start = random_sym(dice, 1200, Dim == 2), by = random_sym(dice, 1e-3, Dim == 2);
      right.push_back(begins(dice, start));
      for (int k = 0; k < sym_size<Dim>; ++k) {
        stress[k].set(l, right[l].stress[k]);
        increment.strain[k].set(l, static_cast<T>(by[k]));
      }
      for (int k = 0; k < state.size; ++k) state[k].set(l, right[l].state[k]);
      right[l].strain(by);
      apart.counted += counts(right[l]);
    }
    update_lanes(
        law, stress, state, increment, [](int) { return true; }, [](int) { return ParticlePlace{}; });
    for (int l = 0; l < W; ++l) {
      for (int k = 0; k < sym_size<Dim>; ++k)
        apart.stress = std::fmax(apart.stress, std::fabs(double(stress[k][l]) - right[l].stress[k]));
      apart.state =
          std::fmax(apart.state, std::fabs(double(state[state_number][l]) - right[l].state[state_number]));
    }
  }
  apart.particles = blocks * W;
  return apart;
}

/// Calls check(real, dimension) for both reals and dimensions.
template <class Check>
void for_each_lanes(const Check& check) {
  check(double{}, std::integral_constant<int, 2>{});
  check(double{}, std::integral_constant<int, 3>{});
  check(float{}, std::integral_constant<int, 2>{});
  check(float{}, std::integral_constant<int, 3>{});
}

}  // namespace mpm::test
