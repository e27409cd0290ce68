#pragma once
// Numbers of each particle that one kernel leaves for the next ones.

#include <Kokkos_Core.hpp>

#include "base/types.hpp"
#include "data/floors.hpp"

namespace mpm {

/// N numbers by particle, in memory of another view.
template <class Space, class T, int N>
using ParticleValues = Kokkos::View<Vector<T, N>*, typename Space::memory_space, Kokkos::MemoryUnmanaged>;

/// Numbers in Core::scratch, until the next kernel that works there. Sorting the particles has made room for
/// a coordinate of each of them, also where they live in memory of the host (Batches::store).
template <int N, class Space, class T, int Dim>
ParticleValues<Space, T, N> values_in_scratch(const Core<Space, T, Dim>& s) {
  static_assert(N <= Dim);
  return ParticleValues<Space, T, N>(reinterpret_cast<Vector<T, N>*>(s.scratch.data()), s.soil.points.count);
}

}  // namespace mpm
