#pragma once
// What every material model shares: its table of parameters, the state it updates, and the rotation of
// stress.

#include "types.hpp"

namespace mpm {

/// One row of a model's table of parameters: everything that the option reader, -help and the checks need.
template <class Model>
struct Parameter {
  const char* key;  // option key: -NAME_key
  typename Model::real Model::*member;
  const char* unit;
  const char* meaning;
  double lowest, highest;  // accepted range, inclusive
  double standard;         // default; NaN where the parameter is required
};

/// What a model updates at a particle.
template <class T, int Dim>
struct MaterialState {
  SymTensor<T, Dim> stress;  // Pa, Cauchy, tension positive
  T plastic_strain;          // -, accumulated engineering plastic shear strain
  T strength;                // Pa, undrained shear strength of this particle
};

/// Stress turned with the material by the spin times dt: Q s Q^T with Q = (I - w/2)^-1 (I + w/2), which is a
/// rotation for any w (Hughes & Winget 1980), so that the Jaumann rate keeps the invariants.
template <class T>
KOKKOS_INLINE_FUNCTION SymTensor<T, 2> rotated(const SymTensor<T, 2>& s, const Spin<T, 2>& w) {
  const T h = w.c[0] / 2, scale = 1 / (1 + h * h);
  const T cos_a = (1 - h * h) * scale, sin_a = 2 * h * scale;
  const T mean = (s[0] + s[1]) / 2, half = (s[0] - s[1]) / 2;
  const T cos_2a = cos_a * cos_a - sin_a * sin_a, sin_2a = 2 * sin_a * cos_a;
  const T half_new = cos_2a * half + sin_2a * s[3];
  return {mean + half_new, mean - half_new, s[2], cos_2a * s[3] - sin_2a * half};
}

template <class T>
KOKKOS_INLINE_FUNCTION SymTensor<T, 3> rotated(const SymTensor<T, 3>& s, const Spin<T, 3>& w) {
  // Cayley transform of the skew tensor W with axial vector a: Q = I + (2/(1+|a|^2/4)) (W/2 + W^2/4)
  const T half[3][3] = {
      {0, w.c[0] / 2, -w.c[2] / 2}, {-w.c[0] / 2, 0, w.c[1] / 2}, {w.c[2] / 2, -w.c[1] / 2, 0}};
  const T scale = 2 / (1 + (w.c[0] * w.c[0] + w.c[1] * w.c[1] + w.c[2] * w.c[2]) / 4);
  T q[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      T square = 0;
      for (int k = 0; k < 3; ++k) square += half[i][k] * half[k][j];
      q[i][j] = (i == j) + scale * (half[i][j] + square);
    }
  SymTensor<T, 3> r;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      T sum = 0;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) sum += q[i][k] * s[sym_index<3>(k, l)] * q[j][l];
      r[sym_index<3>(i, j)] = sum;
    }
  return r;
}

/// Mean stress (s_xx + s_yy + s_zz) / 3.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T mean_of(const SymTensor<T, Dim>& s) {
  return (s[0] + s[1] + s[2]) * T(1.0 / 3);
}

/// Adds the isotropic elastic stress increment lambda tr(e) I + 2 G e to s. Shear strains are tensor
/// components.
template <class R, class T, int Dim>
KOKKOS_INLINE_FUNCTION void add_elastic(SymTensor<R, Dim>& s, const SymTensor<R, Dim>& e, T lambda,
                                        T shear_modulus) {
  const R mean = lambda * (e[0] + e[1] + e[2]);
  for (int k = 0; k < sym_size<Dim>; ++k) s[k] += 2 * shear_modulus * e[k] + (k < 3 ? mean : R(0));
}

/// Elastic constants of Young's modulus and Poisson's ratio.
template <class T>
KOKKOS_INLINE_FUNCTION T shear_modulus_of(T young, T poisson) {
  return young / (2 * (1 + poisson));
}
template <class T>
KOKKOS_INLINE_FUNCTION T lame_of(T young, T poisson) {
  return young * poisson / ((1 + poisson) * (1 - 2 * poisson));
}

}  // namespace mpm
