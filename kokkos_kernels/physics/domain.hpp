#pragma once
// Domains of particles, and the moments of domains that follow the soil (-particle_domain stretch). Such a
// domain begins as the square of its lattice and deforms with the soil to a parallelogram (parallelepiped).
// A particle keeps three times the second moments of its area about its centre, M = sum_k r_k r_k^T with r_k
// = F r_k0 the vectors from the centre to the middles of the sides, a symmetric tensor [cells^2]. The shape
// functions take the box along the axes of the mesh that has the same second moment along each axis, l_d =
// sqrt(M_dd). Moments and half lengths change between steps (functions/follow_soil.hpp), so that a step only
// reads the half lengths.

#include "base/half_length.hpp"
#include "base/types.hpp"
#include "data/particles.hpp"

namespace mpm {

/// Half lengths [cells] of the domain with these moments, `least` at least and k_most_half_length at most.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Vector<T, Dim> bounded_half_lengths(const DomainMoments<T, Dim>& m, T least) {
  Vector<T, Dim> half;
  for (int d = 0; d < Dim; ++d)
    half[d] = Kokkos::fmin(T(k_most_half_length), Kokkos::fmax(least, Kokkos::sqrt(m[d])));
  return half;
}

/// Half lengths [cells] rounded to single precision, as memory holds them.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION Vector<StoredLength<Space, T>, Dim> to_store(const Vector<T, Dim>& half) {
  Vector<StoredLength<Space, T>, Dim> stored;
  for (int d = 0; d < Dim; ++d) stored[d] = static_cast<float>(half[d]);
  return stored;
}

/// Half lengths with their inverses, as R computes with them: a real type, or lanes. The quotient is of
/// single precision, which costs less; Newton's step then makes the inverse that of l, for the weights rely
/// on it.
template <class R, class Stored, int Dim>
KOKKOS_FORCEINLINE_FUNCTION HalfLengths<R, Dim> with_inverses(const Vector<Stored, Dim>& length) {
  using T = RealOf<R>;
  HalfLengths<R, Dim> half;
  for (int d = 0; d < Dim; ++d) {
    half[d].l = R(length[d]);
    half[d].inverse = to_real<R>(0.5f / to_single(length[d]));
    if constexpr (!std::is_same_v<T, float>) half[d].inverse *= T(2) - T(2) * half[d].l * half[d].inverse;
  }
  return half;
}

/// Whether the half length along some axis is at its upper bound.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool is_longest(const DomainMoments<T, Dim>& m) {
  bool longest = false;
  for (int d = 0; d < Dim; ++d) longest = longest || m[d] > T(k_most_half_length * k_most_half_length);
  return longest;
}

/// Moments of a domain that is a square (cube) of this half length [cells].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION DomainMoments<T, Dim> square_domain(T half_length) {
  DomainMoments<T, Dim> m{};
  for (int d = 0; d < Dim; ++d) m[d] = half_length * half_length;
  return m;
}

/// The axis of revolution in the frame of a cell [cells].
template <class T, class Soil_>
KOKKOS_INLINE_FUNCTION T axis_of(const Soil_& soil, int cell) {
  constexpr int cells = Patch<2>::cells;
  return -static_cast<T>(soil.patch_origin[cell / cells][0] + coord_of<2>(cell)[0]);
}

/// The domain of particle p, which is of this body.
template <ParticleDomain domain, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION DomainOf<T, Dim, domain> domain_of(const Soil<Space, T, Dim>& soil, int p,
                                                          const BodyProperties<T>& of) {
  if constexpr (domain == ParticleDomain::fixed)
    return of.half_length;
  else if constexpr (domain == ParticleDomain::ring)
    return {of.half_length, axis_of<T>(soil, soil.cell(p))};
  else
    return with_inverses<T>(soil.half_length(p));
}
/// Domain of a particle where only the run decides whether domains stretch, for work that is not done in
/// every step.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION HalfLengths<T, Dim> any_domain_of(const Soil<Space, T, Dim>& soil, int p) {
  if (soil.has_domain) return with_inverses<T>(soil.half_length(p));
  HalfLengths<T, Dim> half;
  for (int d = 0; d < Dim; ++d) half[d] = soil.bodies(soil.body(p)).half_length;
  return half;
}

/// As domain_of, for kernels that are the same for domains that are fixed and that stretch: those are
/// `stretch`.
template <ParticleDomain domain, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION DomainOf<T, Dim, domain> box_or_ring_of(const Soil<Space, T, Dim>& soil, int p,
                                                               const BodyProperties<T>& of) {
  if constexpr (domain == ParticleDomain::ring)
    return domain_of<domain>(soil, p, of);
  else
    return any_domain_of(soil, p);
}

/// Calls f(domain of particle p), likewise.
template <class Space, class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void with_any_domain(const Soil<Space, T, Dim>& soil, int p, F&& f) {
  if constexpr (Dim == 2)
    if (soil.rings) return f(domain_of<ParticleDomain::ring>(soil, p, soil.bodies(soil.body(p))));
  f(any_domain_of(soil, p));
}

/// Calls f(domain), the domain as std::integral_constant, for kernels that call box_or_ring_of.
template <class Space, class T, int Dim, class F>
void with_box_or_ring(const Soil<Space, T, Dim>& soil, F&& f) {
  if constexpr (Dim == 2)
    if (soil.rings) return f(std::integral_constant<ParticleDomain, ParticleDomain::ring>{});
  f(std::integral_constant<ParticleDomain, ParticleDomain::stretch>{});
}
/// Calls f with the kind of domain that the soil has.
template <class Space, class T, int Dim, class F>
void with_domain(const Soil<Space, T, Dim>& soil, F&& f) {
  if constexpr (Dim == 2)
    if (soil.rings) return f(std::integral_constant<ParticleDomain, ParticleDomain::ring>{});
  if (soil.has_domain)
    f(std::integral_constant<ParticleDomain, ParticleDomain::stretch>{});
  else
    f(std::integral_constant<ParticleDomain, ParticleDomain::fixed>{});
}

}  // namespace mpm
