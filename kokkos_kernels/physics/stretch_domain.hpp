#pragma once
// How the domain of a particle follows the soil in a step (-particle_domain stretch).

#include "physics/domain.hpp"
#include "physics/materials/material.hpp"

namespace mpm {

/// Brings a domain into the bounds within which a particle remembers how its soil was deformed: soil that
/// flows deforms without end. Axis by axis the moments are scaled, M_ij <- s_i s_j M_ij, so that they stay
/// those of a parallelogram. The bounds are far beyond those of the half lengths, so that soil that is
/// compressed and springs back has the domain that it had. T: the type of the numbers in R.
template <class T, class R, int Dim>
KOKKOS_FORCEINLINE_FUNCTION void limit_domain(DomainMoments<R, Dim>& m) {
  constexpr T k_least = T(0.01 * 0.01), k_most = T(4 * 4);  // cells2
  auto inside = (m[0] >= k_least) & (m[0] <= k_most);
  for (int d = 1; d < Dim; ++d) inside = inside & (m[d] >= k_least) & (m[d] <= k_most);
  if (!any_of(!inside)) return;
  R scale[Dim];
  for (int d = 0; d < Dim; ++d) {
    const R within = Kokkos::fmin(k_most, Kokkos::fmax(k_least, m[d]));
    scale[d] = Kokkos::sqrt(within / m[d]);
    m[d] = within;
  }
  for (int i = 0; i < Dim; ++i)
    for (int j = i + 1; j < Dim; ++j) m[moment_index<Dim>(i, j)] *= scale[i] * scale[j];
}

/// Deforms a domain by a step, M <- G M G^T with G = exp(A) to second order and A = L dt, whose trace is that
/// of the strain increment: its dilatation may be the mean of a cell (F-bar), as that of the particle's
/// volume.
template <class R, class T, int Dim>
KOKKOS_FORCEINLINE_FUNCTION void stretch_domain(DomainMoments<R, Dim>& m, const Increment<R, T, Dim>& by) {
  R a[Dim][Dim], correction = 0;
  for (int d = 0; d < 3; ++d) correction += by.strain[d];
  for (int d = 0; d < Dim; ++d) correction -= by.dt * by.gradient[d][d];
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) a[i][j] = by.dt * by.gradient[i][j];
  for (int d = 0; d < Dim; ++d) a[d][d] += correction * T(1.0 / Dim);
  R g[Dim][Dim], gm[Dim][Dim];
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      R square = 0;
      for (int k = 0; k < Dim; ++k) square += a[i][k] * a[k][j];
      g[i][j] = a[i][j] + square / 2;
    }
  for (int d = 0; d < Dim; ++d) g[d][d] += 1;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      gm[i][j] = 0;
      for (int k = 0; k < Dim; ++k) gm[i][j] += g[i][k] * m[moment_index<Dim>(k, j)];
    }
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) {
      R sum = 0;
      for (int k = 0; k < Dim; ++k) sum += gm[i][k] * g[j][k];
      m[moment_index<Dim>(i, j)] = sum;
    }
  limit_domain<T>(m);
}

/// A law that stretches the particle's domain too: the function of `advance` that sees the increment.
template <class R, int Dim, class Law>
struct StretchingLaw {
  const Law& law;
  DomainMoments<R, Dim>& domain;
  template <class T>
  KOKKOS_FORCEINLINE_FUNCTION void operator()(SymTensor<R, Dim>& stress,
                                              const Increment<R, T, Dim>& by) const {
    law(stress, by);
    stretch_domain(domain, by);
  }
};

}  // namespace mpm
