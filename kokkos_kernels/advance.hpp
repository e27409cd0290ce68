#pragma once
// What one step does to one particle (Eqs (11)-(13)), or to as many as an instruction of a processor takes at
// once. The real type R of a particle is T, or lanes of T; parameters are T.

#include "lanes.hpp"
#include "nodes.hpp"
#include "particles.hpp"

namespace mpm {

/// What a particle takes from the nodes.
template <class T, int Dim>
struct Taken {
  T motion[NodeMotion<Dim>::size];  // m/s, m/s2
  T gradient[Dim][Dim];             // 1/s, L_ij = dv_i/dx_j
};

/// Strain increment (symmetric part of L dt, tensor shear strains) and spin increment (skew part).
template <class R, class T, int Dim>
KOKKOS_INLINE_FUNCTION void increments(const R (&L)[Dim][Dim], T dt, SymTensor<R, Dim>& strain,
                                       Spin<R, Dim>& spin) {
  for (int k = 0; k < sym_size<Dim>; ++k) strain[k] = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) strain[sym_index<Dim>(i, j)] = dt * (L[i][j] + L[j][i]) / 2;
  spin.c[0] = dt * (L[0][1] - L[1][0]) / 2;
  if constexpr (Dim == 3) {
    spin.c[1] = dt * (L[1][2] - L[2][1]) / 2;
    spin.c[2] = dt * (L[2][0] - L[0][2]) / 2;
  }
}

/// Scalars of the particle update.
template <class T>
struct UpdateScalars {
  T dt, inv_spacing, flip, pic, f_bar;
};

/// What a step changes of a particle.
template <class T, int Dim>
struct Particle {
  Vector<T, Dim> x, v;  // cells, m/s
  T volume;             // m3
  MaterialState<T, Dim> material;
};

/// Strain and spin by the law of one material.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void update_material(const AnyMaterial<T>& material, MaterialState<T, Dim>& state,
                                            const SymTensor<T, Dim>& d_strain, const Spin<T, Dim>& d_spin,
                                            T dt) {
  material.visit([&](const auto& law) { law.update(state, d_strain, d_spin, dt); });
}

/// One particle's step (Eqs (11)-(13)): strain and stress, volume, velocity, position. The share f_bar of its
/// dilatation is that of its cell, `mean_dilatation` [1/s]. Returns the largest component of its movement
/// [cells]. Material: what update_material takes.
template <class R, class T, int Dim, class Material>
KOKKOS_INLINE_FUNCTION R advance(Particle<R, Dim>& q, const Material& material, const Taken<R, Dim>& t,
                                 R mean_dilatation, const UpdateScalars<T>& by) {
  SymTensor<R, Dim> d_strain;
  Spin<R, Dim> d_spin;
  increments(t.gradient, by.dt, d_strain, d_spin);
  R trace = 0;
  for (int d = 0; d < Dim; ++d) trace += d_strain[d];
  const R correction = by.f_bar * (by.dt * mean_dilatation - trace);
  for (int d = 0; d < 3; ++d) d_strain[d] += correction * T(1.0 / 3);
  trace += correction;
  update_material(material, q.material, d_strain, d_spin, by.dt);

  q.volume *= (2 + trace) / (2 - trace);  // exp(trace) to second order: no drift in rotation
  R moved = 0;
  for (int d = 0; d < Dim; ++d) {
    const R v_i = t.motion[NodeMotion<Dim>::velocity + d], a_i = t.motion[NodeMotion<Dim>::acceleration + d];
    q.v[d] = by.flip * (q.v[d] + by.dt * a_i) + by.pic * v_i;
    const R movement = by.dt * v_i * by.inv_spacing;
    q.x[d] += movement;
    moved = Kokkos::fmax(moved, Kokkos::fabs(movement));
  }
  return moved;
}

/// Whether all values of a particle are finite; by lane where R is lanes.
template <class R, int Dim>
KOKKOS_INLINE_FUNCTION auto is_finite(const Particle<R, Dim>& q) {
  R sum = q.volume;
  for (int d = 0; d < Dim; ++d) sum += q.x[d] + q.v[d];
  for (int k = 0; k < sym_size<Dim>; ++k) sum += q.material.stress[k];
  return 0 * sum == 0;  // 0 times what is not finite is not zero
}

/// What is wrong with a particle that moved by `moved` [cells] in the step: not finite, no volume, or so fast
/// that the computation cannot be trusted.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION FaultKind fault_of(const Particle<T, Dim>& q, T moved) {
  if (!is_finite(q)) return FaultKind::not_finite;
  if (!(q.volume > 0)) return FaultKind::inverted;
  return moved <= 1 ? FaultKind::none : FaultKind::too_fast;
}

}  // namespace mpm
