#pragma once
// Where particles are, for what measures them.

#include "data/state.hpp"

namespace mpm {

/// Where particles are, m from the mesh's lower corner.
template <class Space, class T, int Dim>
struct Positions {
  Soil<Space, T, Dim> soil;
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  double spacing;  // m

  KOKKOS_INLINE_FUNCTION double operator()(int p, int d) const {
    const int cell = soil.cell(p);
    return (double(origin(cell / Patch<Dim>::cells)[d]) + coord_of<Dim>(cell)[d] + soil.coordinate(p)[d]) *
           spacing;
  }
};

template <class Space, class T, int Dim>
Positions<Space, T, Dim> positions_of(const State<Space, T, Dim>& s) {
  return {s.soil.points, s.patches.origin, s.spacing};
}

}  // namespace mpm
