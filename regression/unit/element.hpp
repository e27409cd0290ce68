#pragma once
// A single material point for tests of laws: its parameters by name, paths of strain, paths under a constant
// stress, and replays of files.

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "clouds.hpp"
#include "physics/materials/material.hpp"

namespace mpm::test {

using Sym = std::array<double, 6>;  // xx yy zz xy yz zx
using Values = std::vector<std::pair<std::string, double>>;

/// Random components; some states have equal or zero ones.
inline Sym random_sym(Dice& dice, double size, bool flat) {
  Sym s{};
  for (int k = 0; k < (flat ? 4 : 6); ++k) s[k] = dice.uniform(-size, size);
  const int special = dice.below(12);
  if (special == 0) s[1] = s[0];
  if (special == 1) s[1] = s[2] = s[0];
  if (special == 2) s[3] = s[4] = s[5] = 0;
  if (special == 3) s = {s[0], s[0], s[0], 0, 0, 0};
  return s;
}

/// A law with parameters by their keys; those left out have their defaults.
template <class Law>
Law law_of(const Values& values) {
  Law law{};
  std::size_t used = 0;
  for (const auto& parameter : Law::parameters()) {
    double value = parameter.standard;
    for (const auto& [key, given] : values)
      if (key == parameter.key) value = given, ++used;
    law.*parameter.member = static_cast<typename Law::real>(std::isnan(value) ? 0 : value);
  }
  if (used != values.size()) throw std::runtime_error("a test names a parameter that the law does not have");
  if (!law.check().key.empty()) throw std::runtime_error("parameters of a test: " + law.check().key);
  law.prepare();
  return law;
}

/// A material point of a law in Dim dimensions.
template <class Law, int Dim>
struct Point {
  using T = typename Law::real;
  static constexpr int N = state_size<Law>;
  Law law;
  SymTensor<T, Dim> stress{};  // Pa
  LawState<T, N> state{};

  Point(const Law& of, const Sym& start) : law(of) {
    for (int k = 0; k < sym_size<Dim>; ++k) stress[k] = static_cast<T>(start[k]);
    const auto values = law.initial_state({.position = {}, .height = 0, .stress = start});
    for (int k = 0; k < N; ++k) state[k] = static_cast<T>(values[k]);
  }
  /// One increment of strain (tensor shear strains) in a step dt [s], without spin.
  void strain(const Sym& by, double dt = 1) {
    Increment<T, T, Dim> increment{};
    for (int k = 0; k < sym_size<Dim>; ++k) increment.strain[k] = static_cast<T>(by[k]);
    increment.dt = static_cast<T>(dt);
    law.update(stress, state, increment);
  }
  /// One increment along `free` besides, of the size that gives stress component k the value `target` [Pa].
  /// Secants; the response is piecewise linear.
  void strain_to(const Sym& by, const Sym& free, int k, double target) {
    const Point start = *this;
    const auto misfit = [&](double size) {
      Sym both = by;
      for (int i = 0; i < 6; ++i) both[i] += size * free[i];
      *this = start;
      strain(both);
      return double(stress[k]) - target;
    };
    double a = 0, b = 1e-6, at_a = misfit(a), at_b = misfit(b);
    for (int n = 0; n < 60 && std::fabs(at_b) > 1e-9 * (1 + std::fabs(target)) && at_a != at_b; ++n) {
      const double next = b - at_b * (b - a) / (at_b - at_a);
      a = b, at_a = at_b, b = next, at_b = misfit(next);
    }
    if (!(std::fabs(at_b) < 1e-6 * (1 + std::fabs(target)))) throw std::runtime_error("no such stress");
  }
};

/// A file of replays/: time, total strain, stress and plastic strain (0 where the law has none) of each row.
/// The environment's MPM_REPLAYS names the folder where the program no longer lies by its source
/// (scripts/site/bundle_launch).
struct Replay {
  struct Row {
    Sym strain, stress;
    double plastic_strain, time;  // -, s
  };
  std::vector<Row> rows;

  explicit Replay(const std::string& name) {
    const char* elsewhere = std::getenv("MPM_REPLAYS");
    std::ifstream file(std::string(elsewhere != nullptr ? elsewhere : MPM_REPLAYS) + "/" + name + ".csv");
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line[0] == '#' || line[0] == 't') continue;
      std::istringstream cells(line);
      std::vector<double> values;
      for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
      Row row{};
      for (int k = 0; k < 6; ++k) row.strain[k] = values.at(1 + k), row.stress[k] = values.at(7 + k);
      row.plastic_strain = values.size() > 13 ? values[13] : 0;
      row.time = values[0];
      rows.push_back(row);
    }
    if (rows.size() < 2) throw std::runtime_error("no replay " + name);
  }
};

inline double mean_stress(const Sym& s) { return (s[0] + s[1] + s[2]) / 3; }

/// Largest differences between a replay and its file: of the mean stress over the largest mean (over the
/// largest deviator where that is more), of the components of the deviator, and of the plastic strain, each
/// over the file's largest.
struct Misfit {
  double mean = 0, deviator = 0, plastic_strain = 0;
};

/// forgets_gaps: as the file's program does, soil that has parted takes pressure as soon as it is compressed.
template <class Law, int Dim>
Misfit replay(const Law& law, const Replay& file, int parts, bool forgets_gaps = false) {
  Point<Law, Dim> point(law, file.rows[0].stress);
  Misfit apart, largest;
  for (std::size_t n = 1; n < file.rows.size(); ++n) {
    Sym by, got{};
    for (int k = 0; k < 6; ++k) by[k] = (file.rows[n].strain[k] - file.rows[n - 1].strain[k]) / parts;
    const double dt = (file.rows[n].time - file.rows[n - 1].time) / parts;
    for (int part = 0; part < parts; ++part) {
      point.strain(by, dt);
      if constexpr (requires { Law::parted; })
        if (forgets_gaps) point.state[Law::parted] = 0;
    }
    for (int k = 0; k < sym_size<Dim>; ++k) got[k] = point.stress[k];
    const auto& right = file.rows[n];
    const auto keep = [](double& most, double value) { most = std::fmax(most, std::fabs(value)); };
    keep(largest.mean, mean_stress(right.stress));
    keep(apart.mean, mean_stress(got) - mean_stress(right.stress));
    for (int k = 0; k < 6; ++k) {
      const double of_mean = k < 3 ? mean_stress(right.stress) : 0, of_got = k < 3 ? mean_stress(got) : 0;
      keep(largest.deviator, right.stress[k] - of_mean);
      keep(apart.deviator, got[k] - of_got - (right.stress[k] - of_mean));
    }
    keep(largest.plastic_strain, right.plastic_strain);
    if (point.state.size > 0) keep(apart.plastic_strain, double(point.state[0]) - right.plastic_strain);
  }
  return {apart.mean / std::fmax(largest.mean, largest.deviator), apart.deviator / largest.deviator,
          apart.plastic_strain / std::fmax(largest.plastic_strain, 1e-6)};
}

}  // namespace mpm::test
