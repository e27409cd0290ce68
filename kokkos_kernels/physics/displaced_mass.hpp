#pragma once
// Weight that hydrostatic water takes from the soil (pore_water.hpp).

#include "data/water.hpp"
#include "physics/domain.hpp"

namespace mpm {

/// Share of particle p that is below the level of the water. origin: lower cell of each slot; spacing [m].
template <class Space, class T, int Dim, class Origin>
KOKKOS_INLINE_FUNCTION double submerged_share(const Soil<Space, T, Dim>& points, const Water<Dim>& water,
                                              const Origin& origin, double spacing, int p) {
  const int cell = points.cell(p);
  const Coord<Dim> from = origin(cell / Patch<Dim>::cells), in = coord_of<Dim>(cell);
  const HalfLengths<T, Dim> half_length = any_domain_of(points, p);  // of a ring, that of its plane
  Vector<double, Dim> x, half;                                       // m
  for (int d = 0; d < Dim; ++d) {
    x[d] = (double(from[d]) + in[d] + double(points.coordinate(p)[d])) * spacing;
    half[d] = double(half_length[d].l) * spacing;
  }
  return water.submerged_share(x, half);
}

/// Mass of the water that a particle displaces, rho_w m_p / rho below the level [kg]. rho is the density that
/// the soil began with: when its pores change their volume, water comes and goes, and the weight of the
/// grains under water stays. Where the water of the pores flows, the mass m_p has it as it is, and the
/// particle displaces its present volume.
template <class Space, class T, int Dim>
struct DisplacedMass {
  Soil<Space, T, Dim> points;
  Water<Dim> water;
  Kokkos::View<double*, typename Space::memory_space> density;  // kg/m3, by body
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  double spacing;  // m

  KOKKOS_INLINE_FUNCTION T operator()(int p) const {
    const double share = submerged_share(points, water, origin, spacing, p);
    if (points.has_flow && points.solid_volume(p) > 0)
      return static_cast<T>(water.density * share * double(points.volume(p)));
    const double mass = points.properties(p).mass;
    return static_cast<T>(water.density * share * (mass / density(points.body(p))));
  }
};

}  // namespace mpm
