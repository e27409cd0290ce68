#pragma once
// How the domain of a particle follows the soil (-particle_domain stretch).

#include "base/types.hpp"

namespace mpm {

/// Brings a domain into the bounds within which a particle remembers how its soil was deformed: soil that
/// flows deforms without end. Axis by axis the moments are scaled, M_ij <- s_i s_j M_ij, so that they stay
/// those of a parallelogram. The bounds are far beyond those of the half lengths, so that soil that is
/// compressed and springs back has the domain that it had.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void limit_domain(DomainMoments<T, Dim>& m) {
  constexpr T k_least = T(0.01 * 0.01), k_most = T(4 * 4);  // cells2
  T scale[Dim];
  for (int d = 0; d < Dim; ++d) {
    const T within = Kokkos::fmin(k_most, Kokkos::fmax(k_least, m[d]));
    scale[d] = within == m[d] ? T(1) : Kokkos::sqrt(within / m[d]);
    m[d] = within;
  }
  for (int i = 0; i < Dim; ++i)
    for (int j = i + 1; j < Dim; ++j) m[moment_index<Dim>(i, j)] *= scale[i] * scale[j];
}

/// Deforms a domain, M <- k F M F^T. f: the deformation gradient [-]; scale: k [-].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void stretch_domain(DomainMoments<T, Dim>& m, const double (&f)[Dim][Dim],
                                           double scale) {
  double fm[Dim][Dim];
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      fm[i][j] = 0;
      for (int k = 0; k < Dim; ++k) fm[i][j] += f[i][k] * double(m[moment_index<Dim>(k, j)]);
    }
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) {
      double sum = 0;
      for (int k = 0; k < Dim; ++k) sum += fm[i][k] * f[j][k];
      m[moment_index<Dim>(i, j)] = static_cast<T>(scale * sum);
    }
  limit_domain(m);
}

}  // namespace mpm
