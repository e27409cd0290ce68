#pragma once
#include "physics/materials/clay.hpp"
#include "physics/materials/friction.hpp"
#include "physics/materials/mohr_coulomb_return.hpp"

namespace mpm {

/// Elastic, perfectly plastic clay in undrained loading: yield at s1 - s3 = 2 su, so that the strength is su
/// in every mode of shear; von Mises' circle of the same su carries up to 1.155 times that off plane strain.
/// An optional cut-off of the largest principal stress. Jaumann rate of the Cauchy stress.
template <class T>
struct Tresca : Clay<T> {
  static constexpr const char* k_name = "tresca";
  using Clay<T>::plastic_strain;
  using Clay<T>::strength;
  using Clay<T>::young_of_particle;
  T tension;  // Pa, or k_no_tension
  PyramidShape<T> shape;

  static constexpr auto parameters() {
    const std::array<Parameter<Tresca>, 1> own = {{{"tension",
                                                    &Tresca::tension,
                                                    "Pa",
                                                    "largest principal stress, tension positive",
                                                    0,
                                                    1e12,
                                                    k_no_tension,
                                                    nullptr,
                                                    {{{"none", k_no_tension}}}}}};
    return joined(Clay<T>::template clay_parameters<Tresca>(), own,
                  YoungsModulus<T>::template growth_rows<Tresca>());
  }
  /// Called once the parameters are set.
  void prepare() {
    Clay<T>::prepare();
    shape = PyramidShape<T>::of(0, 0, this->poisson);
  }
  ParameterFault check() const {
    if (this->su == 0 && this->su_gradient == 0)
      return {"su", "a strength in Pa greater than 0 where -NAME_su_gradient is 0"};
    return Clay<T>::check();
  }

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 3>& state,
                              const Increment<R, T, Dim>& by) const {
    const auto& e = this->stiffness;
    const R su_p = state[strength], basis = this->basis_of(su_p, state[young_of_particle]);  // Pa
    const R shear_modulus = e.shear_modulus + e.shear_modulus_over_basis * basis;            // Pa
    s = rotated(s, by.spin);
    add_elastic(s, by.strain, R(e.lambda + e.lambda_over_basis * basis), shear_modulus);
    const PyramidSize<R> size{
        .sc = 2 * su_p, .cut_off = tension, .low = tension - 2 * su_p, .cuts = tension >= 0, .apex = {}};
    state[plastic_strain] += return_stress(shape, size, shear_modulus, s);
  }
};

}  // namespace mpm
