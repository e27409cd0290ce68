#pragma once
// Water that flows in pores at the nodes of a step (physics/pore_flow.hpp).

#include "loops/flow_at_rigids.hpp"
#include "physics/pore_flow.hpp"

namespace mpm {

/// Numbers of the node solve that the nodes of a step share.
template <class Space, class T, int Dim>
struct FlowStep {
  Nodes<Space, T, Dim> nodes;
  Grid<T, Dim> grid, soil_grid;  // as the flux and as the soil meet its sides
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  Vector<double, Dim> g;           // m/s2
  const Vector<T, Dim>* timed_g;   // of the present step, where gravity follows a table; else null
  double dt, share, mass_cut;      // s, of the change of velocities; over the step's length; kg
  NodeField<Space, T, Dim> loads;  // N, on the water; empty where there are none

  FlowStep(const State<Space, T, Dim>& s, double step)
      : nodes(s.nodes),
        grid(grid_of_flow(s.grid, s.flow)),
        soil_grid(s.grid),
        origin(s.patches.origin),
        g(s.gravity),
        timed_g(s.timed.of_step().gravity),
        dt(s.scheme.kick * step),
        share(s.scheme.kick),
        mass_cut(s.scheme.mass_cut),
        loads(s.loads.pore_load) {}

  KOKKOS_INLINE_FUNCTION double gravity(int d) const { return timed_g ? double((*timed_g)[d]) : g[d]; }
  /// Whether node i has water, and forces act there.
  KOKKOS_INLINE_FUNCTION bool is_wet(int i) const {
    return nodes.soil(i, SoilTerms<Dim>::mass) > mass_cut && nodes.flow(i, FlowTerms<Dim>::water) > 0;
  }
  /// Which sides of the mesh node i lies on.
  KOKKOS_INLINE_FUNCTION unsigned sides_at(int i) const {
    return sides_of(grid, in_mesh(origin(i / Patch<Dim>::cells), coord_of<Dim>(i)));
  }
  /// Bit d: no flux along axis d passes a node, which lies on a side that holds the water. sides: sides_at
  /// it.
  KOKKOS_INLINE_FUNCTION unsigned closed_axes(unsigned sides) const {
    unsigned axes = 0;
    for (int d = 0; d < Dim && sides != 0; ++d)
      for (int side = 0; side < 2; ++side)
        if ((sides >> (2 * d + side) & 1u) && grid.wall[d][side] == Wall::roller) axes |= 1u << d;
    return axes;
  }
  /// Whether a side of the mesh that the water passes holds a node, which would have the velocity v along
  /// axis d. sides: sides_of the node.
  KOKKOS_INLINE_FUNCTION bool held_by_open_side(unsigned sides, int d, double v) const {
    for (int side = 0; side < 2; ++side) {
      const Wall wall = soil_grid.wall[d][side];
      if ((sides >> (2 * d + side) & 1u) == 0 || is_open(wall)) continue;
      if (wall != Wall::friction || (side == 0 ? v < 0 : v > 0)) return true;
    }
    return false;
  }
  /// Flux of node i at the beginning of the step [m/s].
  KOKKOS_INLINE_FUNCTION double flux(int i, int d) const {
    using F = FlowTerms<Dim>;
    return double(nodes.flow(i, F::momentum + d)) / double(nodes.flow(i, F::water));
  }
  /// Force of loads on the water at node i [N].
  KOKKOS_INLINE_FUNCTION double load(int i, int d) const {
    return loads.extent(0) > 0 ? double(loads(i, d)) : 0.0;
  }
  /// Sums of node i along axis d, with its weight.
  KOKKOS_INLINE_FUNCTION FlowNode sums(int i, int d) const {
    using F = FlowTerms<Dim>;
    const double mass = nodes.soil(i, SoilTerms<Dim>::mass), drag = nodes.flow(i, F::drag);
    return {mass, nodes.flow(i, F::water), double(nodes.flow(i, F::inertia)) + dt * drag,
            double(nodes.soil(i, SoilTerms<Dim>::force + d)) + mass * gravity(d),
            double(nodes.flow(i, F::force + d)) + double(nodes.flow(i, F::weight)) * gravity(d) + load(i, d) -
                drag * flux(i, d)};
  }
};

/// The solve of a node. Leaves the normal of the rigid body that holds the flux at the node, or zero, in
/// nodes.flux for UpdateFlux.
template <class Space, class T, int Dim, class Rigids>
struct CoupleFlow {
  FlowStep<Space, T, Dim> of;
  Rigids rigids;
  ControlView<Space> control;

  KOKKOS_INLINE_FUNCTION void operator()(int i) const {
    if (control().paused) return;
    const bool wet = of.is_wet(i);
    Vector<double, Dim> normal{};
    if (wet) couple(i, normal);
    for (int d = 0; d < Dim; ++d) of.nodes.flux(i, FluxTerms<Dim>::flux + d) = static_cast<T>(normal[d]);
  }

 private:
  KOKKOS_INLINE_FUNCTION void couple(int i, Vector<double, Dim>& normal) const {
    using S = SoilTerms<Dim>;
    const unsigned sides = of.sides_at(i), closed = of.closed_axes(sides);
    const double mass = of.nodes.soil(i, S::mass), share = of.nodes.flow(i, FlowTerms<Dim>::water) / mass;
    FlowMotion<Dim> motion;
    Vector<double, Dim> a;
    for (int d = 0; d < Dim; ++d) {
      const FlowNode sums = of.sums(i, d);
      const double before = of.flux(i, d);
      const FlowRates rates =
          closed >> d & 1u ? FlowRates{(sums.force + sums.water * before / of.dt) / mass, -before / of.dt}
                           : solve_flow(sums);
      const double grains = double(of.nodes.soil(i, S::momentum + d)) / mass;
      a[d] = rates.grains;
      // The side takes the force of the mixture less the inertia of the flux that it lets pass.
      if ((closed >> d & 1u) == 0 && of.held_by_open_side(sides, d, grains + a[d] * of.dt))
        a[d] = (sums.force - sums.water * sums.water_force / sums.inertia) / mass;
      motion.grains[d] = grains + a[d] * of.dt;
      motion.flux[d] = before + rates.flux * of.dt;
    }
    if (rigids.normal_at(i, motion, share, normal)) {
      const double through = dot(motion.flux, normal);
      for (int d = 0; d < Dim; ++d) a[d] += share * through / of.dt * normal[d];
    } else {
      normal = filled<double, Dim>(0);
    }
    for (int d = 0; d < Dim; ++d)
      of.nodes.soil(i, S::force + d) = static_cast<T>(mass * (a[d] - of.gravity(d)));
  }
};

template <class Space, class T, int Dim>
struct UpdateFlux {
  FlowStep<Space, T, Dim> of;
  ControlView<Space> control;

  KOKKOS_INLINE_FUNCTION void operator()(int i) const {
    if (control().paused) return;
    Vector<double, Dim> before{}, after{}, normal;
    for (int d = 0; d < Dim; ++d) normal[d] = of.nodes.flux(i, FluxTerms<Dim>::flux + d);
    if (of.is_wet(i)) {
      const unsigned closed = of.closed_axes(of.sides_at(i));
      for (int d = 0; d < Dim; ++d) {
        const FlowNode sums = of.sums(i, d);
        const double grains =
            double(of.nodes.kinematics(i, NodeKinematics<Dim>::acceleration + d)) / of.share;
        before[d] = of.flux(i, d);
        if ((closed >> d & 1u) == 0)
          after[d] = before[d] + (sums.water_force - sums.water * grains) / sums.inertia * of.dt;
      }
    }
    const double through = dot(after, normal);
    for (int d = 0; d < Dim; ++d) {
      const double flux = after[d] - through * normal[d];
      of.nodes.flux(i, FluxTerms<Dim>::flux + d) = static_cast<T>(flux);
      of.nodes.flux(i, FluxTerms<Dim>::rate + d) = static_cast<T>((flux - before[d]) / of.dt * of.share);
    }
  }
};

}  // namespace mpm
