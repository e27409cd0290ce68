#pragma once
// The half lengths of a particle's domain, one for all axes or one an axis.

#include <Kokkos_Core.hpp>
#include <type_traits>

#include "base/choices.hpp"
#include "base/spaces.hpp"

namespace mpm {

/// Half length l [cells] of a particle, 0 < l <= 1/2, with 1/(2 l), for which each weight would divide.
template <class T>
struct HalfLength {
  T l, inverse;
  HalfLength() = default;
  KOKKOS_INLINE_FUNCTION HalfLength(T length) : l(length), inverse(T(0.5) / length) {}
  KOKKOS_INLINE_FUNCTION operator T() const { return l; }
  /// Along any axis.
  KOKKOS_INLINE_FUNCTION const HalfLength& operator[](int) const { return *this; }
};
/// As an argument that takes a plain T too.
template <class T>
using HalfLengthOf = const HalfLength<std::type_identity_t<T>>&;

/// Half lengths [cells] along each axis.
template <class T, int Dim>
struct HalfLengths {
  HalfLength<T> axis[Dim];
  KOKKOS_INLINE_FUNCTION HalfLength<T>& operator[](int d) { return axis[d]; }
  KOKKOS_INLINE_FUNCTION const HalfLength<T>& operator[](int d) const { return axis[d]; }
};

/// Type in memory of a half length [cells] of a domain that stretches. Its value is a number of single
/// precision in every space (to_store), so that all spaces compute with the same domains. On a device, where
/// memory limits a step, it takes 4 bytes; on a processor it has the type T, so that a step converts nothing.
template <class Space, class T>
using StoredLength = std::conditional_t<is_device<Space>, float, T>;

/// A square that is revolved about the axis: its half length [cells], and the axis as a coordinate in the
/// frame of the particle's cell [cells].
template <class T>
struct RingDomain {
  HalfLength<T> half;
  T axis_x;
  /// Along any axis, where it does not meet the axis of revolution.
  KOKKOS_INLINE_FUNCTION const HalfLength<T>& operator[](int) const { return half; }
};

/// Type of a particle's domain: the same along all axes and for the whole body, its own along each axis, or a
/// ring.
template <class T, int Dim, ParticleDomain domain>
using DomainOf = std::conditional_t<
    domain == ParticleDomain::fixed, HalfLength<T>,
    std::conditional_t<domain == ParticleDomain::ring, RingDomain<T>, HalfLengths<T, Dim>>>;

/// Weighted sums of nodal values that a particle takes: the derivatives along the axes, and of a ring the
/// mean of the values over the radius, which is the last.
template <int Dim, ParticleDomain domain>
inline constexpr int k_slopes = domain == ParticleDomain::ring ? Dim + 1 : Dim;

}  // namespace mpm
