#pragma once
// The half lengths of a particle's domain, one for all axes or one an axis.

#include <Kokkos_Core.hpp>
#include <type_traits>

#include "base/choices.hpp"

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

/// What a particle's domain is: the same along all axes and for the whole body, or its own along each axis.
template <class T, int Dim, ParticleDomain domain>
using DomainOf = std::conditional_t<domain == ParticleDomain::fixed, HalfLength<T>, HalfLengths<T, Dim>>;

}  // namespace mpm
