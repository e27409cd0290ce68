#pragma once
#include <array>
#include <limits>

#include "materials/material.hpp"

namespace mpm {

/// Elastic, perfectly plastic clay in undrained loading: yield at sqrt(J2) = su, radial return, so that the
/// plane-strain shear strength is su. The strength grows linearly with depth below a level and then belongs
/// to the particle. Jaumann rate of the Cauchy stress.
template <class T>
struct VonMises {
  using real = T;
  static constexpr const char* k_name = "von_mises";
  T young, poisson, su, su_gradient, su_datum;
  T lambda, shear_modulus;  // Pa, of young and poisson

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    return std::array<Parameter<VonMises>, 5>{
        {{"young", &VonMises::young, "Pa", "Young's modulus", 1e-3, 1e15, required},
         {"poisson", &VonMises::poisson, "-", "Poisson's ratio", -0.99, 0.4999, required},
         {"su", &VonMises::su, "Pa", "undrained shear strength at and above su_datum", 0, 1e12, required},
         {"su_gradient", &VonMises::su_gradient, "Pa/m", "growth of the strength with depth", 0, 1e12, 0},
         {"su_datum", &VonMises::su_datum, "m", "level below which the strength grows", -1e9, 1e9, 0}}};
  }
  /// Called once the parameters are set.
  void prepare() {
    lambda = static_cast<T>(lame_of<double>(young, poisson));
    shear_modulus = static_cast<T>(shear_modulus_of<double>(young, poisson));
  }
  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  double wave_modulus() const { return lambda + 2 * shear_modulus; }
  /// Undrained shear strength at a height [m].
  double strength_at(double height) const {
    return su + (height < su_datum ? su_gradient * (su_datum - height) : 0.0);
  }

  /// R: T, or lanes of it.
  template <class R, int Dim>
  KOKKOS_FUNCTION void update(MaterialState<R, Dim>& state, const SymTensor<R, Dim>& d_strain,
                              const Spin<R, Dim>& d_spin, T /*dt*/) const {
    SymTensor<R, Dim>& s = state.stress;
    s = rotated(s, d_spin);
    add_elastic(s, d_strain, lambda, shear_modulus);

    const R mean = mean_of(s);
    R j2 = 0;
    for (int k = 0; k < sym_size<Dim>; ++k) {
      const R deviator = k < 3 ? s[k] - mean : s[k];
      j2 += k < 3 ? deviator * deviator / 2 : deviator * deviator;
    }
    const auto yields = j2 > state.strength * state.strength;
    if (!any_of(yields)) return;
    const R size = Kokkos::sqrt(j2), share = state.strength / size;
    for (int k = 0; k < sym_size<Dim>; ++k)
      s[k] = select(yields, k < 3 ? mean + share * (s[k] - mean) : share * s[k], s[k]);
    state.plastic_strain += select(yields, (size - state.strength) / shear_modulus, R(0));
  }
};

}  // namespace mpm
