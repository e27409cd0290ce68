#pragma once
#include <array>
#include <limits>

#include "materials/material.hpp"

namespace mpm {

/// Isotropic linear elasticity with the Jaumann rate of the Cauchy stress (hypoelastic).
template <class T>
struct LinearElastic {
  using real = T;
  static constexpr const char* k_name = "linear_elastic";
  T young, poisson;
  T lambda, shear_modulus;  // Pa, of young and poisson

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::array<Parameter<LinearElastic>, 2>{
        {{"young", &LinearElastic::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
         {"poisson", &LinearElastic::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required}}};
  }
  /// Called once the parameters are set.
  void prepare() {
    lambda = static_cast<T>(lame_of<double>(young, poisson));
    shear_modulus = static_cast<T>(shear_modulus_of<double>(young, poisson));
  }
  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  double wave_modulus() const { return lambda + 2 * shear_modulus; }
  /// Undrained shear strength at a height [m]; none here.
  double strength_at(double) const { return 0; }

  /// R: T, or lanes of it.
  template <class R, int Dim>
  KOKKOS_FUNCTION void update(MaterialState<R, Dim>& state, const SymTensor<R, Dim>& d_strain,
                              const Spin<R, Dim>& d_spin, T /*dt*/) const {
    state.stress = rotated(state.stress, d_spin);
    add_elastic(state.stress, d_strain, lambda, shear_modulus);
  }
};

}  // namespace mpm
