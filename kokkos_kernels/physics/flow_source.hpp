#pragma once
// Terms that saturated soil gives the nodes beside SoilSource.

#include "physics/displaced_mass.hpp"
#include "physics/p2g_terms.hpp"
#include "physics/pore_flow.hpp"

namespace mpm {

/// FlowTerms of the particles in whose pores water flows. The force on the flux is that of p alone, without
/// the porosity, so that water at rest stays at rest where the porosity jumps.
template <class Space_, class T, int Dim, ParticleDomain domain_ = ParticleDomain::stretch>
struct FlowSource : SourceOfSoil<Space_, T, Dim, FlowTerms<Dim>::size, Kind::motion, domain_> {
  using Terms = FlowTerms<Dim>;
  struct Point {
    DomainOf<T, Dim, domain_> half_length;
    T scalar[4], momentum[Dim];
    T pressure_volume;  // V_p p_p / d
  };
  T inv_spacing;
  decltype(PoreFlow<Space_, Dim>::pores) pores;
  WaterInPores in_pores;
  Water<Dim> water;
  Kokkos::View<Coord<Dim>*, typename Space_::memory_space> origin;
  double spacing;  // m
  Windows<Space_> windows;

  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const auto& points = this->points;
    const BodyProperties<T>& body = points.bodies(points.body(p));
    Point q{box_or_ring_of<domain_>(points, p, body), {}, {}, 0};
    const Pores& of = pores(body.material);
    if (!of.saturated) return q;
    const double volume = points.volume(p), n = 1 - double(points.solid_volume(p)) / volume;
    const double mass = in_pores.density * volume;
    const double sunk = water.is_there() ? submerged_share(points, water, origin, spacing, p) : 0.0;
    q.scalar[Terms::water] = static_cast<T>(mass);
    q.scalar[Terms::inertia] = static_cast<T>(mass / n);
    q.scalar[Terms::drag] = static_cast<T>(volume * in_pores.unit_weight / permeability_at(of, n));
    q.scalar[Terms::weight] = static_cast<T>(mass * (1 - sunk));
    for (int d = 0; d < Dim; ++d) q.momentum[d] = static_cast<T>(mass) * points.flux(p)[d];
    q.pressure_volume = static_cast<T>(volume) * points.history.column[points.history.pore](p) * inv_spacing;
    return q;
  }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int value) {
    return value < Terms::momentum ? -1 : (value - Terms::momentum) % Dim;
  }
  KOKKOS_INLINE_FUNCTION static constexpr bool takes(int value, int d) {
    return value >= Terms::force && value - Terms::force == (d == Dim ? 0 : d);
  }
  KOKKOS_INLINE_FUNCTION static T factor(const Point& q, int value) {
    return value < Terms::momentum ? q.scalar[value] : q.momentum[value - Terms::momentum];
  }
  KOKKOS_INLINE_FUNCTION static T slope(const Point& q, int, int) { return q.pressure_volume; }
};

}  // namespace mpm
