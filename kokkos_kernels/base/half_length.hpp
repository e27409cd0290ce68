#pragma once
// The half length of a particle.

#include <Kokkos_Core.hpp>
#include <type_traits>

namespace mpm {

/// Half length l [cells] of a particle, 0 < l <= 1/2, with 1/(2 l), for which each weight would divide.
template <class T>
struct HalfLength {
  T l, inverse;
  HalfLength() = default;
  KOKKOS_INLINE_FUNCTION HalfLength(T length) : l(length), inverse(T(0.5) / length) {}
  KOKKOS_INLINE_FUNCTION operator T() const { return l; }
};
/// As an argument that takes a plain T too.
template <class T>
using HalfLengthOf = const HalfLength<std::type_identity_t<T>>&;

}  // namespace mpm
