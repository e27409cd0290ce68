#pragma once
// Top floor of the data of a time step (data/floors.hpp), for one execution space, real type and dimension.

#include "data/contact_core.hpp"
#include "data/energy_works.hpp"
#include "data/sides.hpp"
#include "data/surface_loads.hpp"
#include "data/timed_loads.hpp"

namespace mpm {

template <class Space, class T, int Dim>
struct State : ContactCore<Space, T, Dim> {
  TimedLoads<Space, T, Dim> timed;
  Sides<Space, Dim> sides;            // of the mesh, that act on the soil
  SurfaceLoads<Space, T, Dim> loads;  // on parts of bodies' surfaces
  EnergyWorks<Space, T, Dim> energy;  // in use where the run asks for an energy balance
};

/// The nodal fields that a run uses.
template <class Space, class T, int Dim>
NodeUses uses_of_nodes(const State<Space, T, Dim>& s) {
  return {.boundary = s.soil_boundary,
          .strength = s.shear_fraction,
          .water = s.water.is_there(),
          .loads = s.loads.in_use(),
          .residual = s.scheme.xpic_order > 0,
          .correction = s.correction.on,
          .domains = s.soil.points.has_domain,
          .cloud = s.interfaces.in_use(),
          .flow = s.flow.in_use()};
}

}  // namespace mpm
