#pragma once
#include <array>
#include <limits>
#include <optional>

#include "physics/materials/material.hpp"

namespace mpm {

/// The value of a parameter `young` for which its word `field` is given: each particle has its own.
inline constexpr double k_young_of_particle = -1;

/// Rows of tables one after the other.
template <class Row, std::size_t... N>
constexpr std::array<Row, (N + ...)> joined(const std::array<Row, N>&... parts) {
  std::array<Row, (N + ...)> rows{};
  std::size_t k = 0;
  const auto add = [&](const auto& part) {
    for (const Row& row : part) rows[k++] = row;
  };
  (add(parts), ...);
  return rows;
}

/// Young's modulus and Poisson's ratio of a law. Young's modulus is one value, or it varies: it grows
/// linearly with depth below a level, or a file gives it. One that varies belongs to the particle, as the
/// last of its state variables.
template <class T>
struct YoungsModulus {
  using real = T;
  T young, poisson, young_gradient, young_datum;

  template <class Law>
  static constexpr std::array<Parameter<Law>, 2> young_rows() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return {{{"young",
              &Law::young,
              "Pa",
              "Young's modulus; field: each particle's own, from the field or the file of its body",
              1e-3,
              1e15,
              required,
              nullptr,
              {{{"field", k_young_of_particle}}}},
             {"poisson", &Law::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required}}};
  }
  /// The last rows of a law's table.
  template <class Law>
  static constexpr std::array<Parameter<Law>, 2> growth_rows() {
    return {
        {{"young_gradient", &Law::young_gradient, "Pa/m", "growth of Young's modulus with depth", 0, 1e15, 0},
         {"young_datum", &Law::young_datum, "m", "level below which Young's modulus grows", -1e9, 1e9, 0}}};
  }
  /// The last row of a law's table of state variables.
  static constexpr StateVariable young_variable() {
    return {.name = "young", .unit = "Pa", .changes = false, .output = false, .parameter = "young"};
  }

  KOKKOS_INLINE_FUNCTION bool varies() const { return young_gradient > 0 || young < 0; }
  /// Young's modulus [Pa] of the elastic constants that `prepare` computes: 1 where the particles have
  /// theirs.
  double reference_young() const { return varies() ? 1 : young; }
  /// Young's modulus [Pa] of a particle that is created at a height [m]; own [Pa]: what a file gives it.
  double young_at(double height, const std::optional<double>& own) const {
    return own.value_or(young + (height < young_datum ? young_gradient * (young_datum - height) : 0.0));
  }
  ParameterFault young_fault() const {
    if (young < 0 && young_gradient > 0) return {"young_gradient", "0 where -NAME_young is field"};
    return {};
  }
};

/// Young's modulus with the elastic constants. Variable: place of Young's modulus among the state variables.
template <class T, int Variable>
struct Elasticity : YoungsModulus<T> {
  T lambda, shear_modulus;  // Pa, of reference_young()

  void prepare_elasticity() {
    lambda = static_cast<T>(lame_of<double>(this->reference_young(), this->poisson));
    shear_modulus = static_cast<T>(shear_modulus_of<double>(this->reference_young(), this->poisson));
  }

  /// An elastic constant of reference_young() [Pa] for a particle in this state.
  template <class R, int N>
  KOKKOS_INLINE_FUNCTION R of_particle(T constant, const LawState<R, N>& state) const {
    return this->varies() ? R(constant * state[Variable]) : R(constant);
  }
  template <class R, int N>
  KOKKOS_INLINE_FUNCTION R lambda_of(const LawState<R, N>& state) const {
    return of_particle(lambda, state);
  }
  template <class R, int N>
  KOKKOS_INLINE_FUNCTION R shear_modulus_of_particle(const LawState<R, N>& state) const {
    return of_particle(shear_modulus, state);
  }

  /// Adds the elastic stress of an increment of strain. Constants of all particles are no lanes.
  template <class R, int N, int Dim>
  KOKKOS_FORCEINLINE_FUNCTION void add_elastic_to(SymTensor<R, Dim>& s, const SymTensor<R, Dim>& strain,
                                                  const LawState<R, N>& state) const {
    if (this->varies())
      add_elastic(s, strain, lambda_of(state), shear_modulus_of_particle(state));
    else
      add_elastic(s, strain, lambda, shear_modulus);
  }

  /// Soil of one Young's modulus takes no memory for it.
  KOKKOS_FUNCTION bool carries(int k) const { return k != Variable || this->varies(); }
  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim, int N>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const LawState<T, N>& state) const {
    return of_particle(lambda + 2 * shear_modulus, state);
  }
  /// Energy that the soil can give back [J/m3].
  template <int Dim, int N>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const LawState<T, N>& state) const {
    return elastic_energy(stress, lambda_of(state), shear_modulus_of_particle(state));
  }
};

}  // namespace mpm
