#pragma once
// Weight that hydrostatic water takes from the soil (pore_water.hpp).

#include "data/water.hpp"
#include "physics/domain.hpp"

namespace mpm {

/// Mass of the water that a particle displaces, rho_w m_p / rho below the level [kg]. rho is the density that
/// the soil began with: when its pores change their volume, water comes and goes, and the weight of the
/// grains under water stays.
template <class Space, class T, int Dim>
struct DisplacedMass {
  Soil<Space, T, Dim> points;
  Water<Dim> water;
  Kokkos::View<double*, typename Space::memory_space> density;  // kg/m3, by body
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  double spacing;  // m

  KOKKOS_INLINE_FUNCTION T operator()(int p) const {
    const int cell = points.cell(p);
    const Coord<Dim> from = origin(cell / Patch<Dim>::cells), in = coord_of<Dim>(cell);
    const HalfLengths<T, Dim> half_length = any_domain_of(points, p);  // of a ring, that of its plane
    Vector<double, Dim> x, half;                                       // m
    for (int d = 0; d < Dim; ++d) {
      x[d] = (double(from[d]) + in[d] + double(points.coordinate(p)[d])) * spacing;
      half[d] = double(half_length[d].l) * spacing;
    }
    const double share = water.submerged_share(x, half), mass = points.properties(p).mass;
    return static_cast<T>(water.density * share * (mass / density(points.body(p))));
  }
};

}  // namespace mpm
