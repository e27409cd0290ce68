#pragma once
// The box that a particle fills, for measurements of depth and flux.

#include "physics/ring_domain.hpp"
#include "transfer/positions.hpp"

namespace mpm {

/// The domain of a particle: its centre and half lengths [m, from the mesh's lower corner].
template <int Dim>
struct ParticleBox {
  double centre[Dim], half[Dim];
};

/// The box of a particle. The box of a ring ends at the axis.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION ParticleBox<Dim> box_of(const Positions<Space, T, Dim>& position, int p) {
  ParticleBox<Dim> box;
  const HalfLengths<T, Dim> half = any_domain_of(position.soil, p);
  for (int d = 0; d < Dim; ++d) {
    box.centre[d] = position(p, d);
    box.half[d] = double(half[d].l) * position.spacing;
  }
  if (position.soil.rings) {
    const double low = Kokkos::fmax(0.0, box.centre[0] - box.half[0]), high = box.centre[0] + box.half[0];
    box.centre[0] = (low + high) / 2, box.half[0] = (high - low) / 2;
  }
  return box;
}

/// Share of the volume of an interval [low, high] along an axis that is in [from, to]; `ring`: along the
/// radius, where volumes grow with it.
KOKKOS_INLINE_FUNCTION double share_between(double low, double high, double from, double to, bool ring) {
  const double a = Kokkos::fmax(low, from), b = Kokkos::fmin(high, to);
  if (!(b > a)) return 0;
  return (b - a) / (high - low) * (ring ? (a + b) / (low + high) : 1.0);
}

}  // namespace mpm
